#include "orient/jets.h"

#include "base/vector.h"
#include "cloud/exact_plane.h"
#include "cloud/neighbours.h"
#include "cloud/plane_fit.h"
#include "cloud/quadratic_patch.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"

#include <algorithm>
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

// The normal at 0 of the jet through members about it, where they prove it, it holds 0, and it does not turn away from `normal`; 0
// elsewhere.
Vec3 normal_of_jet(const std::vector<FitPoint>& members, const Vector3d& normal, double spacing) {
  if (members.size() <= kQuadraticTerms || !is_spread_out(members, normal)) return {0, 0, 0};
  const QuadraticPatch patch = fit_quadratic_patch(members, 0, spacing, 0);
  const double scatter = residual(patch, members);
  if (scatter > kScatter * spacing) return {0, 0, 0};
  Vector3d fitted;
  const double distance = patch.distance(Vector3d::Zero(), &fitted);
  if (std::abs(distance) > kSigmas * std::max(scatter, kExactScatter * spacing)) return {0, 0, 0};
  if (fitted.dot(normal) <= kSamePatch) return {0, 0, 0};
  return {fitted[0], fitted[1], fitted[2]};
}

// Of these neighbours of a point those whose normals are within 26 degrees of one, about the point and weighted.
void gather(const PointSet& set, std::size_t i, const std::uint32_t* near, std::size_t count, const std::vector<Vec3>& normals,
            const Vec3& normal, std::vector<FitPoint>& members) {
  const double reach = kWeightReach * set.smoothed_spacing()[i];
  members.clear();
  for (std::size_t k = 0; k < count; ++k) {
    if (vector::dot(normals[near[k]], normal) <= kSamePatch) continue;
    const Vector3d d = to_eigen(set.points()[near[k]]) - to_eigen(set.points()[i]);
    members.push_back({d, to_eigen(normals[near[k]]), std::exp(-d.squaredNorm() / (2 * reach * reach)), 0});
  }
}

// The points whose normals are proven.
struct ProvenPoints {
  std::vector<std::uint32_t> index;  // among all points
  std::vector<Vec3> points;

  ProvenPoints(const std::vector<Vec3>& all, const std::vector<std::uint8_t>& proven) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (proven[i] == 0) continue;
      index.push_back(static_cast<std::uint32_t>(i));
      points.push_back(all[i]);
    }
  }
};

}  // namespace

std::vector<std::uint8_t> fit_jets(const PointSet& set, std::vector<Vec3>& normals) {
  const std::size_t size = set.size();
  std::vector<std::uint8_t> proven(size, 0);
  if (size < kSpacingNeighbours) return proven;
  const std::vector<double>& spacing = set.smoothed_spacing();
  const std::vector<std::uint32_t>& near = set.near();
  std::vector<Vec3> out = normals;
  parallel::for_blocks(size, parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<FitPoint> members;
    for (std::size_t i = begin; i < end; ++i) {
      gather(set, i, near.data() + i * kSpacingNeighbours, kSpacingNeighbours, normals, normals[i], members);
      const Vec3 fitted = normal_of_jet(members, to_eigen(normals[i]), spacing[i]);
      if (vector::dot(fitted, fitted) == 0) continue;
      out[i] = fitted;
      proven[i] = 1;
    }
  });
  normals = std::move(out);
  return proven;
}

void fit_jets_at_creases(const PointSet& set, const std::vector<std::uint8_t>& proven, std::vector<Vec3>& normals) {
  const ProvenPoints known(set.points(), proven);
  if (known.index.size() <= kQuadraticTerms || known.index.size() == set.size()) return;
  const Neighbours tree(known.points);
  const std::vector<double>& spacing = set.smoothed_spacing();
  std::vector<Vec3> out = normals;
  parallel::for_blocks(set.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    std::vector<double> squared;
    std::vector<FitPoint> members;
    std::vector<Vec3> tried;
    std::vector<Vec3> found;
    for (std::size_t i = begin; i < end; ++i) {
      if (proven[i] != 0) continue;
      tree.nearest(set.points()[i], kPlaneNeighbours, near, squared);
      for (std::uint32_t& j : near) j = known.index[j];
      tried.clear();
      found.clear();
      for (const std::uint32_t j : near) {
        const Vec3& start = normals[j];
        const auto is_alike = [&](const Vec3& n) { return vector::dot(n, start) > kSamePatch; };
        if (vector::dot(start, normals[i]) <= kSameSide || std::any_of(tried.begin(), tried.end(), is_alike)) continue;
        tried.push_back(start);
        gather(set, i, near.data(), near.size(), normals, start, members);
        const Vec3 fitted = normal_of_jet(members, to_eigen(start), spacing[i]);
        if (vector::dot(fitted, fitted) > 0) found.push_back(fitted);
      }
      if (found.size() == 1) out[i] = found.front();
    }
  });
  normals = std::move(out);
}

}  // namespace g3r
