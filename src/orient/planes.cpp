#include "orient/planes.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cpu/parallel.h"

#include <cmath>
#include <cstddef>

namespace g3r {
namespace {

// Share of the points whose planes are aside of the field's normals: slices have 1.1 to 27 %.
constexpr double kFewAside = 0.01;
// Terms of a plane that chance does not make, from 10 points on it.
constexpr std::uint32_t kMany = 8;
// Dimension of the points on such planes: 1.7 to 2.1 on facets, 1.5 on wires, 1.1 to 1.3 on slices.
constexpr double kCurves = 1.4;

// A plane found, and the sum of ln(d_k / d_j) over the distances of its other points j < k to the first, of which k is the farthest.
struct Found {
  Vec3 normal{0, 0, 0};
  std::uint32_t terms = 0;  // 0: no plane
  float logarithms = 0;
};

Found find_at(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing, double scatter,
              const Vec3& towards) {
  ExactPlane plane = find_exact_plane(points, index, spacing, &towards);
  if (plane.points.empty() && scatter > 0) plane = find_scattered_plane(points, index, spacing, scatter, towards);
  if (plane.points.empty()) return {};
  const auto squared_distance = [&](std::uint32_t j) {
    const Vec3 d = vector::subtract(points[j], points[plane.points.front()]);
    return vector::dot(d, d);
  };
  const double farthest = squared_distance(plane.points.back());
  double logarithms = 0;
  for (std::size_t k = 1; k + 1 < plane.points.size(); ++k) logarithms += std::log(farthest / squared_distance(plane.points[k])) / 2;
  return {plane.normal, static_cast<std::uint32_t>(plane.points.size() - 2), static_cast<float>(logarithms)};
}

// Slices, and scan lines denser along than across, have planes of their own, across the surface. Then the planes that are aside of the
// field's normals hold curves: their dimension, by maximum likelihood (Levina and Bickel, "Maximum likelihood estimation of intrinsic
// dimension", NIPS 2004), pooled over all such planes, is that of lines.
bool are_slices(const std::vector<Found>& found, const std::vector<Vec3>& normals) {
  std::size_t aside = 0;
  std::size_t terms = 0;
  double logarithms = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].terms < kMany || std::abs(vector::dot(found[i].normal, normals[i])) > kSamePatch) continue;
    ++aside;
    terms += found[i].terms;
    logarithms += found[i].logarithms;
  }
  return static_cast<double>(aside) > kFewAside * static_cast<double>(found.size()) && static_cast<double>(terms) < kCurves * logarithms;
}

}  // namespace

void fit_planes(const PointSet& set, double scatter, std::vector<std::uint8_t>& proven, std::vector<Vec3>& normals) {
  const std::vector<Vec3>& points = set.points();
  const std::vector<double>& spacing = set.smoothed_spacing();
  const Neighbours& tree = set.tree();
  std::vector<Found> found(points.size());
  parallel::for_blocks(points.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) {
      if (proven[i] != 0) continue;
      tree.nearest(points[i], kPlaneNeighbours, index, squared);
      found[i] = find_at(points, index, spacing[i], scatter, normals[i]);
    }
  });
  if (are_slices(found, normals)) return;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].terms == 0) continue;
    proven[i] = 1;
    normals[i] = vector::scale(found[i].normal, vector::dot(found[i].normal, normals[i]) < 0 ? -1 : 1);
  }
}

}  // namespace g3r
