#include "inputs.h"

#include <g3r/error.h>
#include <g3r/metrics.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>

#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cloud/spacing.h"
#include "mesh/used_vertices.h"
#include "metrics/random.h"

namespace g3r::bench {

namespace {

constexpr double kOutlierBox = 1.2;    // outliers fill the bounding box, enlarged by this factor about its centre
constexpr double kPatchRadius = 0.05;  // of the box diagonal
constexpr double kStripes = 10;        // as many dense as sparse
constexpr std::size_t kPcpnetPoints = 100000;
constexpr std::array<const char*, 6> kPcpnet = {"pcpnet:clean", "pcpnet:0.12",    "pcpnet:0.6",
                                                "pcpnet:1.2",   "pcpnet:stripes", "pcpnet:gradient"};
constexpr double kPcpnetRatio = 10;  // of the densities
constexpr std::size_t kMaxChunks = 1000;

constexpr double kOppositeCosine = -0.5;  // 120 degrees: another side, not the other face of an edge

// Streams of the seed. Chunks of samples count on from kChunkStream.
constexpr std::uint64_t kOutlierStream = 100;
constexpr std::uint64_t kKeepStream = 101;
constexpr std::uint64_t kPatchStream = 102;
constexpr std::uint64_t kChunkStream = 1000;

double diagonal(const vector::Box& box) {
  const Vec3 d = vector::subtract(box.high, box.low);
  return std::sqrt(vector::dot(d, d));
}

Input sampled(const Mesh& mesh, std::size_t count, std::uint64_t seed, double noise) {
  Samples samples = sample_mesh(mesh, count, seed, noise);
  return {std::move(samples.points), std::move(samples.normals), count, noise, {}};
}

/// `count` samples for which `keep` is true.
Input selected(const Mesh& mesh, std::size_t count, std::uint64_t seed, const std::function<bool(const Vec3&)>& keep) {
  Input input;
  for (std::size_t chunk = 0; input.points.size() < count; ++chunk) {
    if (chunk == kMaxChunks) throw InvalidInput("almost no sample of the mesh can be kept");
    const Samples samples = sample_mesh(mesh, count, Random(seed, kChunkStream + chunk).bits());
    for (std::size_t i = 0; i < count && input.points.size() < count; ++i) {
      if (!keep(samples.points[i])) continue;
      input.points.push_back(samples.points[i]);
      input.normals.push_back(samples.normals[i]);
    }
  }
  input.surface = count;
  return input;
}

Input with_outliers(const Mesh& mesh, std::size_t count, std::uint64_t seed, double percent, const vector::Box& box) {
  const auto outliers = static_cast<std::size_t>(std::lround(static_cast<double>(count) * percent / 100));
  Input input = sampled(mesh, count - outliers, seed, 0);
  Random random(seed, kOutlierStream);
  const Vec3 centre = box.centre();
  for (std::size_t i = 0; i < outliers; ++i) {
    Vec3 p = centre;
    for (std::size_t k = 0; k < 3; ++k) p[k] += kOutlierBox * (box.high[k] - box.low[k]) * (random.uniform() - 0.5);
    input.points.push_back(p);
  }
  return input;
}

/// Samples kept with probability ratio^-exponent(t), where t is the position along the longest side of the box from 0 to 1.
Input thinned(const Mesh& mesh, std::size_t count, std::uint64_t seed, double ratio, const vector::Box& box,
              const std::function<double(double)>& exponent) {
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (box.high[k] - box.low[k] > box.high[axis] - box.low[axis]) axis = k;
  }
  const double log_ratio = Random::natural_log(ratio);
  Random random(seed, kKeepStream);
  return selected(mesh, count, seed, [&](const Vec3& p) {
    const double t = (p[axis] - box.low[axis]) / (box.high[axis] - box.low[axis]);
    // uniform < ratio^-exponent, with a logarithm that is the same on every machine
    return Random::natural_log(1 - random.uniform()) < -exponent(t) * log_ratio;
  });
}

// 0 in dense stripes, 1 in sparse ones. The first is dense.
double is_sparse(double t) { return std::fmod(std::floor(kStripes * t), 2); }

/// Balls about random points of the surface stay empty.
Input with_patches(const Mesh& mesh, std::size_t count, std::uint64_t seed, std::size_t patches, const vector::Box& box) {
  const std::vector<Vec3> centres = sample_mesh(mesh, patches, Random(seed, kPatchStream).bits()).points;
  const double radius = kPatchRadius * diagonal(box);
  return selected(mesh, count, seed, [&](const Vec3& p) {
    return std::none_of(centres.begin(), centres.end(), [&](const Vec3& c) {
      const Vec3 d = vector::subtract(p, c);
      return vector::dot(d, d) < radius * radius;
    });
  });
}

Input made(const Mesh& mesh, const InputKind& kind, std::size_t count, std::uint64_t seed) {
  const vector::Box box = box_of_used_vertices(mesh);
  switch (kind.defect) {
    case InputKind::Defect::kNoise:
      return sampled(mesh, count, seed, kind.value / 100 * diagonal(box));
    case InputKind::Defect::kOutliers:
      return with_outliers(mesh, count, seed, kind.value, box);
    case InputKind::Defect::kGradient:
      return thinned(mesh, count, seed, kind.value, box, [](double t) { return t; });
    case InputKind::Defect::kStripes:
      return thinned(mesh, count, seed, kind.value, box, is_sparse);
    case InputKind::Defect::kPatches:
      return with_patches(mesh, count, seed, static_cast<std::size_t>(kind.value), box);
    case InputKind::Defect::kNone:
      break;
  }
  return sampled(mesh, count, seed, 0);
}

std::vector<bool> thin_parts(const Input& input) {
  const std::vector<Vec3> points(input.points.begin(), input.points.begin() + static_cast<std::ptrdiff_t>(input.surface));
  const double h = typical_spacing(local_spacing(points));
  const double reach = std::max(kThinSpacings * h, kThinDeviations * input.noise);
  const Neighbours neighbours(points);
  std::vector<bool> thin(points.size());
  std::vector<std::uint32_t> near;
  for (std::size_t i = 0; i < points.size(); ++i) {
    neighbours.within(points[i], reach, near);
    thin[i] = std::any_of(near.begin(), near.end(),
                          [&](std::uint32_t j) { return vector::dot(input.normals[i], input.normals[j]) < kOppositeCosine; });
  }
  return thin;
}

}  // namespace

std::vector<std::filesystem::path> find_models(const std::string& folder, const std::vector<std::string>& models) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    const bool is_mesh = extension == ".ply" || extension == ".obj" || extension == ".off" || extension == ".stl";
    if (entry.is_regular_file() && is_mesh) paths.push_back(entry.path());
  }
  if (paths.empty()) throw InvalidInput("no mesh to measure in " + folder);
  std::sort(paths.begin(), paths.end());
  if (models.empty()) return paths;
  std::vector<std::filesystem::path> wanted;
  for (const std::string& model : models) {
    const auto found = std::find_if(paths.begin(), paths.end(), [&](const auto& path) { return path.stem() == model; });
    if (found == paths.end()) throw InvalidInput("no mesh named " + model + " in " + folder);
    wanted.push_back(*found);
  }
  return wanted;
}

InputKind parse_input_kind(const std::string& text) {
  using Defect = InputKind::Defect;
  const auto pcpnet = [&text](Defect defect, double value) { return InputKind{text, defect, value, kPcpnetPoints}; };
  if (text == "clean") return {text, Defect::kNone, 0};
  if (text == "pcpnet:clean") return pcpnet(Defect::kNone, 0);
  if (text == "pcpnet:0.12") return pcpnet(Defect::kNoise, 0.12);
  if (text == "pcpnet:0.6") return pcpnet(Defect::kNoise, 0.6);
  if (text == "pcpnet:1.2") return pcpnet(Defect::kNoise, 1.2);
  if (text == "pcpnet:stripes") return pcpnet(Defect::kStripes, kPcpnetRatio);
  if (text == "pcpnet:gradient") return pcpnet(Defect::kGradient, kPcpnetRatio);
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  double value = 0;
  const char* end = text.data() + text.size();
  const bool number = colon != std::string::npos && std::from_chars(text.data() + colon + 1, end, value).ptr == end;
  if (number && name == "noise" && value > 0 && value <= 10) return {text, Defect::kNoise, value};
  if (number && name == "outliers" && value > 0 && value <= 90) return {text, Defect::kOutliers, value};
  if (number && name == "gradient" && value > 1 && value <= 1000) return {text, Defect::kGradient, value};
  if (number && name == "stripes" && value > 1 && value <= 1000) return {text, Defect::kStripes, value};
  if (number && name == "patches" && value >= 1 && value <= 100) return {text, Defect::kPatches, std::floor(value)};
  throw InvalidInput("input '" + text +
                     "' is none of clean, noise:0..10, outliers:0..90, gradient:1..1000, stripes:1..1000, patches:1..100, pcpnet, "
                     "pcpnet:clean|0.12|0.6|1.2|stripes|gradient");
}

std::vector<InputKind> parse_input_kinds(const std::vector<std::string>& texts) {
  std::vector<InputKind> kinds;
  for (const std::string& text : texts) {
    if (text == "pcpnet") {
      for (const char* const each : kPcpnet) kinds.push_back(parse_input_kind(each));
    } else {
      kinds.push_back(parse_input_kind(text));
    }
  }
  return kinds;
}

Input make_input(const Mesh& mesh, const InputKind& kind, std::size_t count, std::uint64_t seed) {
  Input input = made(mesh, kind, count, seed);
  input.thin = thin_parts(input);
  return input;
}

}  // namespace g3r::bench
