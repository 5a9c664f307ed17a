#include "cloud/spacing.h"

#include "cloud/point_tree.h"
#include "cpu/parallel.h"
#include "median.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace g3r {
namespace {

constexpr std::size_t kNeighbours = 8;  // enough to average out random sampling, few enough to stay local
constexpr std::size_t kSmoothing = 16;  // neighbours that share their spacing
constexpr std::size_t kBlock = 1024;    // points per parallel block

}  // namespace

std::vector<double> local_spacing(const std::vector<Vec3>& points) {
  const std::size_t k = std::min(kNeighbours, points.size() - 1);
  const PointSet set{points};
  const PointTree tree(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kPointTreeLeaf));
  const double factor = std::sqrt(std::numbers::pi / static_cast<double>(k));
  std::vector<double> spacing(points.size());
  parallel::for_blocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint32_t, kNeighbours + 1> index{};
    std::array<double, kNeighbours + 1> squared{};
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t found = tree.knnSearch(points[i].data(), k + 1, index.data(), squared.data());
      spacing[i] = std::max(kLeastSpacing, factor * std::sqrt(squared[found - 1]));
    }
  });
  return spacing;
}

std::vector<double> smoothed_spacing(const std::vector<Vec3>& points, const std::vector<double>& local) {
  const PointSet set{points};
  const PointTree tree(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kPointTreeLeaf));
  std::vector<double> logarithm(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) logarithm[i] = std::log(local[i]);
  std::vector<double> spacing(points.size());
  parallel::for_blocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint32_t, kSmoothing> index{};
    std::array<double, kSmoothing> squared{};
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t found = tree.knnSearch(points[i].data(), kSmoothing, index.data(), squared.data());
      double sum = 0;
      for (std::size_t k = 0; k < found; ++k) sum += logarithm[index[k]];
      spacing[i] = std::exp(sum / static_cast<double>(found));
    }
  });
  return spacing;
}

double typical_spacing(std::vector<double> local) { return median(std::move(local)); }

}  // namespace g3r
