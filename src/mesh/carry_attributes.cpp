#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cloud/far_points.h"
#include "cloud/morton.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/mesh_parts.h"

#include <g3r/g3r.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace g3r {
namespace {

using Color = std::array<std::uint8_t, 3>;

// The points whose colours are mixed at a vertex: more would blur, and one would look blocky.
constexpr std::size_t kLenders = 4;

std::uint8_t rounded(double value) { return static_cast<std::uint8_t>(std::lround(value)); }

// Distinct finite points, but for far_points(), in canonical order, so that what is equally near is the same for every order of the input.
struct Carriers {
  std::vector<Vec3> points;
  std::vector<Color> colors;      // empty, or the mean of those at each place
  std::vector<float> confidence;  // empty, or the mean of those at each place that are finite, NaN if none is
  std::vector<Vec3> normals;      // empty, or the mean of the unit normals at each place
};

std::vector<Vec3> in_unit_box(const PointsView& points, const std::vector<std::uint32_t>& finite) {
  vector::Box box;
  for (const std::uint32_t i : finite) box.extend(points[i]);
  const double half = box.longest_side() / 2;
  Frame frame{box.centre(), half > 0 ? 1 / half : 1};
  if (!std::isfinite(frame.scale) || !(frame.scale > 0)) frame.scale = 1;
  std::vector<Vec3> unit(finite.size());
  parallel::for_all(unit.size(), [&](std::size_t k) { unit[k] = frame.to_unit(points[finite[k]]); });
  return unit;
}

// Of those that are finite, NaN if none is.
float mean_of(std::vector<float>& values) {
  std::erase_if(values, [](float value) { return !std::isfinite(value); });
  if (values.empty()) return std::numeric_limits<float>::quiet_NaN();
  std::sort(values.begin(), values.end());  // sums depend on their order
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value);
  return static_cast<float>(sum / static_cast<double>(values.size()));
}

// Of those that are finite, (0, 0, 0) if none is.
Vec3 mean_direction(std::vector<Vec3>& normals) {
  std::erase_if(normals, [](const Vec3& n) { return !vector::is_finite(n); });
  if (normals.empty()) return {0, 0, 0};
  for (Vec3& n : normals) n = vector::normalised(n);
  std::sort(normals.begin(), normals.end());  // sums depend on their order
  return vector::mean(normals);
}

Carriers carriers_of(const PointsView& points, const std::vector<Color>& colors, const std::vector<float>& confidence,
                     const PointsView& normals) {
  const std::vector<std::uint8_t> is_far = far_points(points);
  std::vector<std::uint32_t> finite;
  for (std::size_t i = 0; i < points.count; ++i) {
    if (vector::is_finite(points[i]) && (is_far.empty() || is_far[i] == 0)) finite.push_back(static_cast<std::uint32_t>(i));
  }
  const std::vector<Vec3> unit = in_unit_box(points, finite);
  const std::vector<std::uint32_t> order = morton_order(unit);
  Carriers out;
  out.points.reserve(order.size());
  out.colors.reserve(colors.empty() ? 0 : order.size());
  out.confidence.reserve(confidence.empty() ? 0 : order.size());
  out.normals.reserve(normals.count == 0 ? 0 : order.size());
  std::vector<float> sure;
  std::vector<Vec3> directions;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    Vec3 place = points[finite[order[begin]]];
    std::array<double, 3> color{};
    sure.clear();
    directions.clear();
    for (end = begin; end < order.size() && unit[order[end]] == unit[order[begin]]; ++end) {
      const std::uint32_t i = finite[order[end]];
      place = std::min(place, points[i]);  // they may differ in a digit that the unit box does not show
      for (std::size_t a = 0; a < 3 && !colors.empty(); ++a) color[a] += colors[i][a];
      if (!confidence.empty()) sure.push_back(confidence[i]);
      if (normals.count != 0) directions.push_back(normals[i]);
    }
    const auto count = static_cast<double>(end - begin);
    out.points.push_back(place);
    if (!colors.empty()) out.colors.push_back({rounded(color[0] / count), rounded(color[1] / count), rounded(color[2] / count)});
    if (!confidence.empty()) out.confidence.push_back(mean_of(sure));
    if (normals.count != 0) out.normals.push_back(mean_direction(directions));
  }
  return out;
}

// The points that lend to a vertex, nearest first, and their squared distances.
struct Lenders {
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
};

// The nearest ones. Where some of them are on the other side of a wall or gap, the nearest on this side, as far as the surface there was
// fitted to them, if there is any.
class LenderSearch {
 public:
  LenderSearch(const Mesh& mesh, const Carriers& carriers) : mesh_(mesh), carriers_(carriers), neighbours_(carriers.points) {
    if (!carriers.normals.empty()) normals_ = mesh::vertex_normals(mesh);
  }

  void find(std::size_t vertex, Lenders& out) const {
    const Vec3& x = mesh_.vertices[vertex];
    const auto faces_away = [&](std::uint32_t i) { return vector::dot(carriers_.normals[i], normals_[vertex]) < -mesh::kSlant; };
    neighbours_.nearest(x, kLenders, out.index, out.squared);
    if (normals_.empty() || std::none_of(out.index.begin(), out.index.end(), faces_away)) return;
    neighbours_.nearest(x, mesh::kFitPoints, out.index, out.squared);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < out.index.size() && kept < kLenders; ++k) {
      if (faces_away(out.index[k])) continue;
      out.index[kept] = out.index[k];
      out.squared[kept++] = out.squared[k];
    }
    if (kept == 0) kept = std::min(kLenders, out.index.size());
    out.index.resize(kept);
    out.squared.resize(kept);
  }

 private:
  const Mesh& mesh_;
  const Carriers& carriers_;
  const Neighbours neighbours_;
  std::vector<Vec3> normals_;  // of the vertices, where the points have some
};

}  // namespace

void carry_attributes(Mesh& mesh, const PointsView& points, const std::vector<Color>& colors, const std::vector<float>& confidence,
                      const Monitor& monitor, const PointsView& normals) {
  if ((!colors.empty() && colors.size() != points.count) || (!confidence.empty() && confidence.size() != points.count)) {
    throw InvalidInput("colours or confidences differ in number from the points");
  }
  if (normals.count != 0 && normals.count != points.count) throw InvalidInput("normals differ in number from the points");
  if (colors.empty() && confidence.empty()) return;
  if (monitor.progress && !monitor.progress("carry", 0)) throw Cancelled();
  const Carriers carriers = carriers_of(points, colors, confidence, normals);
  if (carriers.points.empty()) return;
  const LenderSearch search(mesh, carriers);
  mesh.colors.resize(colors.empty() ? 0 : mesh.vertices.size());
  mesh.confidence.resize(confidence.empty() ? 0 : mesh.vertices.size());
  const auto carry = [&](std::size_t begin, std::size_t end) {
    Lenders lenders;
    for (std::size_t v = begin; v < end; ++v) {
      search.find(v, lenders);
      const auto& [index, squared] = lenders;
      // A vertex on a point takes that point's colour, and nothing is divided by 0.
      const double floor = mesh::kRounding * squared.back() + std::numeric_limits<double>::min();
      double total = 0, sure = 0, sure_total = 0;
      std::array<double, 3> color{};
      for (std::size_t k = 0; k < index.size(); ++k) {
        const double weight = 1 / (squared[k] / floor + 1);
        const std::uint32_t i = index[k];
        total += weight;
        for (std::size_t a = 0; a < 3 && !colors.empty(); ++a) color[a] += weight * carriers.colors[i][a];
        if (confidence.empty() || !std::isfinite(carriers.confidence[i])) continue;
        sure += weight * static_cast<double>(carriers.confidence[i]);
        sure_total += weight;
      }
      if (!confidence.empty()) mesh.confidence[v] = sure_total > 0 ? static_cast<float>(sure / sure_total) : 0;
      for (std::size_t a = 0; a < 3 && !colors.empty(); ++a) mesh.colors[v][a] = rounded(color[a] / total);
    }
  };
  parallel::for_blocks(mesh.vertices.size(), parallel::kSmallBlock, carry, monitor.cancel);
}

}  // namespace g3r
