#include "cloud/neighbours.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "cpu/parallel.h"

namespace g3r {
namespace {

constexpr std::size_t kLeaf = 12;  // points per leaf of the k-d tree; a matter of speed only

struct Cloud {
  const std::vector<Vec3>& p;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return p.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t d) const { return p[i][d]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// The nearest point so far, as nanoflann's searches see it.
struct Nearest {
  std::uint32_t index;
  double squared;
  [[nodiscard]] bool full() const { return true; }
  [[nodiscard]] double worstDist() const { return squared; }
  bool addPoint(double distance, std::uint32_t point) {
    if (distance < squared) squared = distance, index = point;
    return true;
  }
};

// The k nearest points that have a mark.
class NearestMarked {
 public:
  NearestMarked(std::size_t k, const std::vector<std::uint8_t>& marks, std::uint32_t* index, double* squared) : found_(k), marks_(marks) {
    found_.init(index, squared);
  }
  [[nodiscard]] std::size_t size() const { return found_.size(); }
  [[nodiscard]] bool full() const { return found_.full(); }
  [[nodiscard]] double worstDist() const { return found_.worstDist(); }
  bool addPoint(double distance, std::uint32_t point) { return marks_[point] == 0 || found_.addPoint(distance, point); }

 private:
  nanoflann::KNNResultSet<double, std::uint32_t> found_;
  const std::vector<std::uint8_t>& marks_;
};

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>;

}  // namespace

struct Neighbours::Tree {
  Cloud cloud;
  KdTree index;
  explicit Tree(const std::vector<Vec3>& p) : cloud{p}, index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kLeaf)) {
    index.buildIndex();
  }
};

Neighbours::Neighbours(const std::vector<Vec3>& positions) : tree_(std::make_unique<Tree>(positions)) {}
Neighbours::~Neighbours() = default;

void Neighbours::nearest(const Vec3& x, std::size_t k, std::vector<std::uint32_t>& index, std::vector<double>& squared) const {
  k = std::min(k, tree_->cloud.p.size());
  index.resize(k);
  squared.resize(k);
  tree_->index.knnSearch(x.data(), k, index.data(), squared.data());
}

void Neighbours::nearest_marked(const Vec3& x, std::size_t k, const std::vector<std::uint8_t>& marks, std::vector<std::uint32_t>& index,
                                std::vector<double>& squared) const {
  index.resize(k);
  squared.resize(k);
  NearestMarked found(k, marks, index.data(), squared.data());
  tree_->index.findNeighbors(found, x.data(), {});
  index.resize(found.size());
  squared.resize(found.size());
}

std::uint32_t Neighbours::nearest(const Vec3& x, double& squared, std::uint32_t none) const {
  Nearest result{none, squared};
  tree_->index.findNeighbors(result, x.data(), {});
  squared = result.squared;
  return result.index;
}

void Neighbours::within(const Vec3& x, double radius, std::vector<std::uint32_t>& index) const {
  std::vector<std::pair<std::uint32_t, double>> matches;
  tree_->index.radiusSearch(x.data(), radius * radius, matches, nanoflann::SearchParams(0, 0, false));
  index.clear();
  for (const auto& match : matches) index.push_back(match.first);
}

std::vector<std::uint32_t> Neighbours::of_all(std::size_t k) const {
  const std::vector<Vec3>& points = tree_->cloud.p;
  k = std::min(k, points.size());
  std::vector<std::uint32_t> out(points.size() * k);
  parallel::for_blocks(points.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<double> squared(k);
    for (std::size_t i = begin; i < end; ++i) tree_->index.knnSearch(points[i].data(), k, out.data() + i * k, squared.data());
  });
  return out;
}

}  // namespace g3r
