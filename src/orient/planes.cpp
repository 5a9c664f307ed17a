#include "orient/planes.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/plane_fit.h"
#include "cloud/viewpoint.h"
#include "cpu/parallel.h"

#include <cmath>
#include <cstddef>

namespace g3r {
namespace {

// The median breadth below which planes hold curves: those of rings of a dozen points have 0.31, of slices 0.05 to 0.3, of facets 0.40 to
// 0.49.
constexpr double kCurveBreadth = 0.35;

struct Found {
  Vec3 normal{0, 0, 0};  // 0: there is no plane
  double breadth = 0;    // of its nearest points, one more than determine it: more follow the bend of a ring
};

// The plane through the first of the points, an exact one or else one of scattered points.
Found find_at(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing, double scatter,
              const Vec3& towards) {
  ExactPlane plane = find_exact_plane(points, index, spacing, &towards);
  if (plane.points.empty() && scatter > 0) plane = find_scattered_plane(points, index, spacing, scatter, towards);
  if (plane.points.empty()) return {};
  return {plane.normal, fit_plane(points, plane.points.data(), kPlaneTerms + 1).breadth};
}

// Slices, and scan lines denser along than across, have planes of their own, across the surface: more of the planes are aside of the
// field's normals than chance has proven, and they hold curves. At most of them the nearest points lie along a line.
bool are_slices(const std::vector<Found>& found, const std::vector<Vec3>& normals) {
  std::vector<double> aside;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].breadth > 0 && std::abs(vector::dot(found[i].normal, normals[i])) <= kSamePatch) aside.push_back(found[i].breadth);
  }
  return static_cast<double>(aside.size()) > kFalseAlarms * static_cast<double>(found.size()) && median(aside) < kCurveBreadth;
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
      if (is_along_sight(set, i, found[i].normal)) found[i] = {};
    }
  });
  if (are_slices(found, normals)) return;
  parallel::for_all(found.size(), [&](std::size_t i) {
    if (vector::dot(found[i].normal, found[i].normal) == 0) return;
    proven[i] = 1;
    normals[i] = vector::scale(found[i].normal, vector::dot(found[i].normal, normals[i]) < 0 ? -1 : 1);
  });
}

}  // namespace g3r
