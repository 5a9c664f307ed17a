#include "orient/jets.h"

#include "cloud/plane_fit.h"
#include "cloud/quadratic_patch.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace g3r {
namespace {

using Eigen::Vector3d;

// Spacings, standard deviation of the heights about a jet: more takes rough surfaces for smooth ones.
constexpr double kScatter = 0.007;

// Whether the members lie around a place in the plane across the normal, and not along a line.
bool is_spread_out(const std::vector<FitPoint>& members, const Vector3d& normal) {
  const Eigen::Matrix3d frame = tangent_frame(normal);
  Vector3d mean = Vector3d::Zero();
  for (const FitPoint& m : members) mean += m.p / static_cast<double>(members.size());
  double uu = 0;
  double uv = 0;
  double vv = 0;
  for (const FitPoint& m : members) {
    const Vector3d d = frame * (m.p - mean);
    uu += d[0] * d[0];
    uv += d[0] * d[1];
    vv += d[1] * d[1];
  }
  const double middle = (uu + vv) / 2;
  const double swing = std::hypot((uu - vv) / 2, uv);
  return middle - swing >= kLineBreadth * kLineBreadth * (middle + swing);
}

}  // namespace

std::vector<std::uint8_t> fit_jets(const PointSet& set, std::vector<Vec3>& normals) {
  const std::vector<Vec3>& points = set.points();
  std::vector<std::uint8_t> proven(points.size(), 0);
  if (points.size() < kSpacingNeighbours) return proven;
  const std::vector<double>& spacing = set.smoothed_spacing();
  const std::vector<std::uint32_t>& near = set.near();
  std::vector<Vec3> out = normals;
  parallel::for_blocks(points.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<FitPoint> members;
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d centre = to_eigen(points[i]);
      const Vector3d normal = to_eigen(normals[i]);
      const double scale = 1 / (2 * kWeightReach * kWeightReach * spacing[i] * spacing[i]);
      members.clear();
      for (std::size_t k = 0; k < kSpacingNeighbours; ++k) {
        const std::uint32_t j = near[i * kSpacingNeighbours + k];
        const Vector3d d = to_eigen(points[j]) - centre;
        const Vector3d n = to_eigen(normals[j]);
        if (n.dot(normal) <= kSamePatch) continue;
        members.push_back({d, n, std::exp(-d.squaredNorm() * scale), 0});
      }
      if (members.size() <= kQuadraticTerms || !is_spread_out(members, normal)) continue;
      const QuadraticPatch patch = fit_quadratic_patch(members, 0, spacing[i], 0);
      if (residual(patch, members) > kScatter * spacing[i]) continue;
      Vector3d fitted;
      (void)patch.distance(Vector3d::Zero(), &fitted);
      if (fitted.dot(normal) <= kSamePatch) continue;
      out[i] = {fitted[0], fitted[1], fitted[2]};
      proven[i] = 1;
    }
  });
  normals = std::move(out);
  return proven;
}

}  // namespace g3r
