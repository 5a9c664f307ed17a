#include "cloud/spacing.h"

#include "cpu/parallel.h"

#include <nanoflann.hpp>

#include <cmath>
#include <numbers>

namespace g3r {
namespace {

constexpr std::size_t kNeighbours = 8;     // enough to average out random sampling, few enough to stay local
constexpr std::size_t kBlock = 1024;       // points per parallel block
constexpr std::size_t kLeafPoints = 16;    // of the k-d tree

struct PointSet {
  const std::vector<Vec3>& points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointSet>, PointSet, 3, std::uint32_t>;

}  // namespace

std::vector<double> local_spacing(const std::vector<Vec3>& points) {
  const std::size_t k = std::min(kNeighbours, points.size() - 1);
  const PointSet set{points};
  const KdTree tree(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafPoints));
  const double factor = std::sqrt(std::numbers::pi / static_cast<double>(k));
  std::vector<double> spacing(points.size());
  parallel::for_blocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint32_t, kNeighbours + 1> index{};
    std::array<double, kNeighbours + 1> squared{};
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t found = tree.knnSearch(points[i].data(), k + 1, index.data(), squared.data());
      spacing[i] = factor * std::sqrt(squared[found - 1]);
    }
  });
  return spacing;
}

double typical_spacing(std::vector<double> local) {
  const auto middle = local.begin() + static_cast<std::ptrdiff_t>(local.size() / 2);
  std::nth_element(local.begin(), middle, local.end());
  return *middle;
}

}  // namespace g3r
