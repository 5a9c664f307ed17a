// libFuzzer target for the whole pipeline. The first kOptionBytes bytes choose the options, good and bad ones, the rest is a cloud of at
// most kMaxPoints points: a file of any format, or plain coordinates (small integers make duplicates, lines and planes likely).
#include <g3r/g3r.h>
#include <g3r/io.h>

#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>

#include "pipeline_fuzz.h"
#include "require.h"

namespace {

using g3r::fuzz::require;

constexpr std::size_t kMaxPoints = 64;
constexpr double kUnitTolerance = 1e-6;

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  /// One of the values, by the next byte.
  template <class T>
  T pick(std::initializer_list<T> values) {
    if (size_ == 0) return *values.begin();
    --size_;
    return *(values.begin() + *data_++ % values.size());
  }
  [[nodiscard]] const std::uint8_t* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

g3r::Options options_from(Bytes& bytes) {
  using Unit = g3r::Length::Unit;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  g3r::Options o;
  o.preset = bytes.pick({g3r::Preset::kDefault, g3r::Preset::kPaper});
  o.method = bytes.pick({g3r::Method::kAuto, g3r::Method::kGreen, g3r::Method::kEnergy});
  o.epsilon.unit = bytes.pick({Unit::kAuto, Unit::kInput, Unit::kPercent, Unit::kSpacing, Unit::kNormalised});
  o.epsilon.value = bytes.pick({0.3, 1e-12, 1.0, 100.0, 1e300, 0.0, -1.0, kNan});
  o.noise.unit = bytes.pick({Unit::kAuto, Unit::kInput, Unit::kPercent, Unit::kSpacing, Unit::kNormalised});
  o.noise.value = bytes.pick({0.0, 0.3, 1e-12, 3.0, 1e300, -1.0, kNan});
  o.degree = bytes.pick({-1, 0, 1, 2, 8, 9});
  o.harmonics = bytes.pick<const char*>({"", "1", "1,x,y,z", "degree:0-2", "xy,yz", "degree:3-1", "q"});
  o.solver = bytes.pick({g3r::Solver::kAuto, g3r::Solver::kDense, g3r::Solver::kConjugateGradient});
  o.schedule = bytes.pick<const char*>({"", "1 cg", "2 sd 3 cg", "0 cg", "-1 sd", "cg"});
  o.tolerance = bytes.pick({-1.0, 0.0, 1e-3, 1.0, kNan});
  o.accuracy = bytes.pick({1e-2, 0.0, 1e-6, 0.1, 1.0, kNan});
  o.condition_number = bytes.pick({false, true});
  o.threads = bytes.pick({1, 2, 0, -1});
  o.max_memory = bytes.pick<std::size_t>({0, 1 << 20, 1 << 30});
  o.without = bytes.pick<const char*>({"", "planes", "facets,areas", "polish,open-surfaces", "certificate", "q"});
  return o;
}

g3r::Hints hints_from(Bytes& bytes, std::size_t points) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::initializer_list<g3r::Vec3> places = {{0, 0, 0}, {0, 0, 1}, {-200, 3, 500}, {1e300, 0, 0}, {1e-300, 0, 0}, {kNan, 0, 0}};
  g3r::Hints h;
  if (bytes.pick({false, true})) h.up = bytes.pick(places);
  for (int k = bytes.pick({0, 1, 2}); k > 0; --k) h.sensors.push_back(bytes.pick(places));
  if (const std::size_t count = bytes.pick<std::size_t>({0, points, points + 1}); count > 0)
    h.sensor_of_point.assign(count, bytes.pick<std::uint32_t>({0, 1, 2, g3r::kNoSensor}));
  if (bytes.pick({false, true})) h.inside.push_back(bytes.pick(places));
  h.seen_from_inside = bytes.pick({false, true});
  h.flip = bytes.pick({false, true});
  return h;
}

g3r::MeshOptions mesh_options_from(Bytes& bytes) {
  using Trim = g3r::MeshOptions::Trim;
  g3r::MeshOptions o;
  o.mesher = bytes.pick({g3r::Mesher::kAuto, g3r::Mesher::kField, g3r::Mesher::kPoisson});
  o.depth = bytes.pick({0, 4, 5, 13});  // 6 and more take up to half a minute here; 13 is refused
  o.trim = bytes.pick({Trim::kOff, Trim::kAuto, Trim::kDistance});
  o.trim_distance = bytes.pick({0.5, 1e-9, 1e9, 0.0, -1.0});
  o.keep_largest = bytes.pick<std::size_t>({0, 1, 1000});
  o.min_component = bytes.pick({8.0, 0.0, 1e9, -1.0});
  o.faces = bytes.pick<std::size_t>({0, 1, 50});
  return o;
}

template <class T>
std::vector<g3r::Vec3> plain_points(const Bytes& bytes) {
  std::vector<g3r::Vec3> points(std::min(kMaxPoints, bytes.size() / (3 * sizeof(T))));
  for (std::size_t i = 0; i < points.size(); ++i) {
    T p[3];
    std::memcpy(p, bytes.data() + i * sizeof p, sizeof p);
    points[i] = {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }
  return points;
}

std::vector<g3r::Vec3> points_of_file(const Bytes& bytes) {
  std::vector<g3r::Vec3> points = g3r::read_cloud_bytes(bytes.data(), bytes.size(), "input").positions;
  if (points.size() > kMaxPoints) points.resize(kMaxPoints);
  return points;
}

std::vector<g3r::Vec3> points_from(g3r::fuzz::Coding coding, const Bytes& bytes) {
  switch (coding) {
    case g3r::fuzz::Coding::kFile:
      return points_of_file(bytes);
    case g3r::fuzz::Coding::kInteger:
      return plain_points<std::int8_t>(bytes);
    case g3r::fuzz::Coding::kFloat:
      return plain_points<float>(bytes);
    case g3r::fuzz::Coding::kDouble:
      return plain_points<double>(bytes);
  }
  return {};
}

void check(const std::vector<g3r::Vec3>& points, const g3r::Orientation& o) {
  require(o.normals.size() == points.size() && o.areas.size() == points.size() && o.confidence.size() == points.size(), "one per point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const g3r::Vec3& n = o.normals[i];
    const double length = std::hypot(n[0], n[1], n[2]);
    const bool finite = std::isfinite(points[i][0]) && std::isfinite(points[i][1]) && std::isfinite(points[i][2]);
    require(finite ? std::abs(length - 1) < kUnitTolerance : length == 0, "a unit normal for every finite point");
    require(o.areas[i] >= 0, "areas are not negative");
    require(o.confidence[i] >= 0 && o.confidence[i] <= 1, "confidence is in [0, 1]");
  }
}

void check(const g3r::Reconstruction& r, const g3r::MeshOptions& options) {
  require(!r.mesh.triangles.empty(), "no empty mesh");
  for (const auto& v : r.mesh.vertices) require(std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]), "finite vertices");
  for (const auto& t : r.mesh.triangles) {
    for (const std::uint32_t v : t) require(v < r.mesh.vertices.size(), "indices name vertices");
  }
  if (options.trim == g3r::MeshOptions::Trim::kOff) require(r.check.closed && r.check.manifold, "closed and manifold");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using g3r::fuzz::Coding;
  const g3r::fuzz::MemoryLaw law(size);
  if (size < g3r::fuzz::kOptionBytes) return -1;
  Bytes choices(data, g3r::fuzz::kOptionBytes);
  const auto coding = choices.pick({Coding::kFile, Coding::kInteger, Coding::kFloat, Coding::kDouble});
  g3r::Options options = options_from(choices);
  const g3r::MeshOptions mesh_options = mesh_options_from(choices);
  try {
    const auto points = points_from(coding, {data + g3r::fuzz::kOptionBytes, size - g3r::fuzz::kOptionBytes});
    options.hints = hints_from(choices, points.size());
    check(points, g3r::orient(points, options));
    const g3r::Reconstruction r = g3r::reconstruct(points, options, mesh_options);
    check(points, r.orientation);
    check(r, mesh_options);
  } catch (const g3r::InvalidInput&) {
  } catch (const g3r::Unavailable&) {
  }
  return 0;
}
