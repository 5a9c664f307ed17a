#include "cloud/outliers.h"

#include "base/vector.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace g3r {
namespace {

constexpr std::size_t kFewNeighbours = 8;
constexpr double kSparse = 2;         // local spacing against the neighbours', of those alone, and against the typical one
constexpr double kVolumetric = 0.07;  // share of the smallest principal spread; 1/3 in a ball
constexpr double kThin = 0.1;         // of the farthest neighbour's distance, half of what a plane holds: more holds strays, less no bends
constexpr std::ptrdiff_t kHeld = 10;  // of 15 points: one in a hundred that fill space has a plane with as many
constexpr std::size_t kFewestPoints = 100;  // below, sparse parts are a matter of chance
constexpr double kMostOutliers = 1.0 / 3;

bool fills_space(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < count; ++k) mean += Eigen::Map<const Eigen::Vector3d>(points[index[k]].data()) / static_cast<double>(count);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d d = Eigen::Map<const Eigen::Vector3d>(points[index[k]].data()) - mean;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[0] > kVolumetric * spread.trace();
}

// Whether some plane through a point, the first of these, and two of the next holds most of the others, as that of a surface as sparse as
// the point does, though strays among them fill space. An a contrario test (Desolneux, Moisan and Morel, "From Gestalt Theory to Image
// Analysis", 2008): that many are not there by chance.
bool on_a_plane(const std::vector<Vec3>& points, const std::uint32_t* index) {
  std::array<Vec3, kSpacingNeighbours> q;
  for (std::size_t k = 1; k < q.size(); ++k) q[k] = vector::subtract(points[index[k]], points[*index]);
  const double half = kThin * kThin * vector::dot(q.back(), q.back());
  for (std::size_t a = 1; a <= kFewNeighbours; ++a) {
    for (std::size_t b = 1; b < a; ++b) {
      const Vec3 m = vector::cross(q[a], q[b]);
      const double most = half * vector::dot(m, m);
      const auto held = std::count_if(q.begin() + 1, q.end() - 1, [&](const Vec3& v) {
        const double d = vector::dot(v, m);
        return d * d <= most;
      });
      if (held >= kHeld) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::uint32_t> find_outliers(const PointSet& set, const std::vector<double>& relative_spacing) {
  if (set.size() < kFewestPoints) return {};
  const std::vector<Vec3>& points = set.points();
  const std::vector<std::uint32_t>& near = set.near();
  const std::vector<double> local = spacing_before_thinning(set.local_spacing(), relative_spacing);
  const double typical = typical_spacing(local);
  std::vector<char> outlier(points.size(), 0);
  parallel::for_blocks(points.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (local[i] <= 1.5 * typical) continue;  // most points; both rules ask for more
      const std::uint32_t* index = near.data() + i * set.near_count();
      double neighbours = 0;  // mean logarithm
      for (std::size_t k = 1; k <= kFewNeighbours; ++k) neighbours += std::log(local[index[k]]) / kFewNeighbours;
      const bool alone = std::log(local[i]) - neighbours > std::log(kSparse);
      outlier[i] =
          alone || (local[i] > kSparse * typical && fills_space(points, index, kSpacingNeighbours) && !on_a_plane(points, index)) ? 1 : 0;
    }
  });
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < outlier.size(); ++i) {
    if (outlier[i] != 0) indices.push_back(i);
  }
  if (static_cast<double>(indices.size()) > kMostOutliers * static_cast<double>(points.size())) indices.clear();
  return indices;
}

std::vector<Vec3> remove_points(CanonicalCloud& cloud, const std::vector<std::uint32_t>& indices) {
  if (indices.empty()) return {};
  const std::size_t staying = cloud.size() - indices.size();
  std::vector<Vec3> removed;
  std::vector<std::uint32_t> removed_multiplicity;
  std::vector<std::uint32_t> renumbered(cloud.size());
  std::vector<Vec3> points;
  std::vector<std::uint64_t> morton;
  points.reserve(staying);
  morton.reserve(staying);
  for (std::uint32_t i = 0; i < renumbered.size(); ++i) {
    if (removed.size() < indices.size() && indices[removed.size()] == i) {
      renumbered[i] = static_cast<std::uint32_t>(staying + removed.size());
      removed.push_back(cloud.points()[i]);
      removed_multiplicity.push_back(cloud.multiplicity[i]);
      continue;
    }
    renumbered[i] = static_cast<std::uint32_t>(points.size());
    cloud.multiplicity[points.size()] = cloud.multiplicity[i];
    points.push_back(cloud.points()[i]);
    morton.push_back(cloud.morton()[i]);
  }
  cloud.set = PointSet(std::move(points), std::move(morton));
  std::copy(removed_multiplicity.begin(), removed_multiplicity.end(), cloud.multiplicity.begin() + static_cast<std::ptrdiff_t>(staying));
  for (std::uint32_t& p : cloud.point_of) {
    if (p < renumbered.size()) p = renumbered[p];
  }
  return removed;
}

}  // namespace g3r
