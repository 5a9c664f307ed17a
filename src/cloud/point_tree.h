// The k-d tree for nearest neighbours. Internal to src/cloud.
#pragma once

#include <g3r/points.h>

#include <nanoflann.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

inline constexpr std::size_t kPointTreeLeaf = 16;

struct PointSet {
  const std::vector<Vec3>& points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using PointTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointSet>, PointSet, 3, std::uint32_t>;

}  // namespace g3r
