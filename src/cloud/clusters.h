// Points that a wide kernel cannot distinguish, taken together.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// A partition of N points into the cells of a grid: M centroids in canonical order and what they stand for.
struct Clusters {
  std::vector<Vec3> points;               ///< M centroids
  std::vector<double> multiplicity;       ///< M: of the points in the cell, added up
  std::vector<double> relative_spacing;   ///< M: root mean square of that of the points in the cell; empty if none is given
  std::vector<std::uint32_t> cluster_of;  ///< N: point -> cluster

  [[nodiscard]] std::vector<double> roots() const;  ///< M: of the multiplicities
};

/// Cells of the Morton grid with a side of at most `side` and more than side / 2. `points` in canonical order.
/// `relative_spacing`: of each point, whose multiplicity is its square, the area that it stands for; empty for ones. O(N).
[[nodiscard]] Clusters cluster_points(const std::vector<Vec3>& points, double side, const std::vector<double>& relative_spacing = {});

}  // namespace g3r
