#include "mesh/lines.h"

#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace g3r::mesh {
namespace {

using vector::dot;
using vector::subtract;

// The points among which the next line is searched for: of lines a hundred times as far apart as their points, those of a quarter turn.
constexpr std::size_t kMostPoints = 256;

// The spread of a point and its ring, `near` the nearest of each, about their mean.
Eigen::Matrix3d spread_around(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near, std::size_t i) {
  const std::size_t stride = near.size() / points.size(), count = std::min(kRing + 1, stride);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 d = subtract(points[near[i * stride + k]], points[i]);
    const Eigen::Vector3d e(d[0], d[1], d[2]);
    mean += e / static_cast<double>(count);
    spread += e * e.transpose() / static_cast<double>(count);
  }
  return spread - mean * mean.transpose();
}

}  // namespace

std::vector<std::uint8_t> points_along_curves(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near) {
  std::vector<std::uint8_t> out(points.size(), 0);
  parallel::for_blocks(out.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d variance =
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread_around(points, near, i), Eigen::EigenvaluesOnly).eigenvalues();
      out[i] = variance[1] <= kLittle * variance[2] ? 1 : 0;  // on surfaces one point in 1,000 is below twice this
    }
  });
  return out;
}

std::vector<std::uint8_t> points_in_lines(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near) {
  const std::size_t n = points.size(), stride = near.size() / n, voters = std::min(kFitPoints, stride);
  const std::vector<std::uint8_t> thin = points_along_curves(points, near);
  std::vector<std::uint8_t> out(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t votes = 0;
    for (std::size_t k = 0; k < voters; ++k) votes += thin[near[i * stride + k]];
    out[i] = static_cast<double>(votes) >= kInLines * static_cast<double>(voters) ? 1 : 0;
  }
  // Where lines meet they look like a surface, and would stay rough.
  const auto marked = static_cast<std::size_t>(std::count(out.begin(), out.end(), std::uint8_t{1}));
  if (2 * marked >= n) std::fill(out.begin(), out.end(), std::uint8_t{1});
  return out;
}

std::vector<double> spacing_across_lines(const std::vector<Vec3>& points, const std::vector<double>& spacing) {
  const Neighbours neighbours(points);
  const std::vector<std::uint32_t> near = neighbours.of_all(kFitPoints);
  const std::vector<std::uint8_t> in_lines = points_in_lines(points, near);
  std::vector<double> out = spacing;
  parallel::for_blocks(out.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) {
      if (in_lines[i] == 0) continue;
      const Eigen::Vector3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread_around(points, near, i)).eigenvectors().col(2);
      neighbours.nearest(points[i], kMostPoints, index, squared);
      const auto next = std::find_if(index.begin(), index.end(), [&](std::uint32_t j) {
        const Vec3 d = subtract(points[j], points[i]);
        return std::abs(dot(d, {axis[0], axis[1], axis[2]})) < kAlong * std::sqrt(dot(d, d));
      });
      if (next != index.end()) out[i] = std::max(out[i], 0.5 * std::sqrt(squared[static_cast<std::size_t>(next - index.begin())]));
    }
  });
  return out;
}

}  // namespace g3r::mesh
