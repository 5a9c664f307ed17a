#include "cloud/wires.h"

#include "base/median.h"
#include "cloud/constants.h"
#include "cloud/quadratic_patch.h"
#include "cloud/some_places.h"
#include "cpu/parallel.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

// A point and its nearest, seen along the line that they are next to.
struct AlongLine {
  double roundness = 0;           // the lesser spread across it over the greater; negative: they lie along no line
  std::size_t in_the_middle = 0;  // of them, those less than half of their root mean square distance from it
};

// `rounded`: how far rounding moves a point across a line, at most.
AlongLine look_along(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double rounded) {
  const auto count = static_cast<double>(index.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : index) mean += to_eigen(points[i]) / count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::uint32_t i : index) spread += (to_eigen(points[i]) - mean) * (to_eigen(points[i]) - mean).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(spread);
  const Eigen::Vector3d squared = eigen.eigenvalues().cwiseMax(0);
  const double across = std::sqrt((squared[0] + squared[1]) / count);
  if (across <= rounded || std::sqrt(squared[1]) >= kClearlyLess * std::sqrt(squared[2])) return {-1, 0};
  AlongLine seen{std::sqrt(squared[0] / squared[1]), 0};
  const Eigen::Vector3d line = eigen.eigenvectors().col(2);
  for (const std::uint32_t i : index) {
    if (line.cross(to_eigen(points[i]) - mean).norm() < kClearlyLess * across) ++seen.in_the_middle;
  }
  return seen;
}

}  // namespace

bool are_wires(const PointSet& set) {
  const SomePlaces some = SomePlaces::at_least(kPlaces, set.size());
  std::vector<AlongLine> seen(some.size());
  const Neighbours& tree = set.tree();
  const Vec3 steps = set.rounding_steps();
  const double rounded = std::max({steps[0], steps[1], steps[2]}) * std::numbers::sqrt2 / 2;
  parallel::for_blocks(seen.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t k = begin; k < end; ++k) {
      tree.nearest(set.points()[some[k]], kPatchNeighbours, index, squared);
      seen[k] = look_along(set.points(), index, rounded);
    }
  });
  std::vector<double> roundness;
  std::size_t in_the_middle = 0;
  for (const AlongLine& line : seen) {
    if (line.roundness < 0) continue;
    roundness.push_back(line.roundness);
    in_the_middle += line.in_the_middle;
  }
  if (roundness.empty() || median(roundness) < kClearlyLess) return false;
  // Shares within half of the root mean square distance from the axis. A density that does not rise outwards has that of a disk at least.
  const double of_disk = kClearlyLess * kClearlyLess / 2;
  const double of_noise = 1 - std::exp(-kClearlyLess * kClearlyLess);
  const double found = static_cast<double>(in_the_middle) / static_cast<double>(roundness.size() * kPatchNeighbours);
  return found < (of_disk + of_noise) / 2;
}

}  // namespace g3r
