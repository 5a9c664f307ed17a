#include "cloud/neighbours.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/vector.h"
#include "cpu/parallel.h"
#include "gpu/execution.h"
#include "gpu/neighbours_on_device.h"

namespace g3r {
namespace {

constexpr std::size_t kLeaf = 16;       // points per leaf: fewer make more nodes, more are looked at in vain; a matter of speed only
constexpr std::size_t kMostThere = 64;  // nearest points that a device looks for, which it keeps in registers
constexpr std::size_t kMany = 128;      // nearest points, from which sorting them at last is faster than keeping them sorted
constexpr std::size_t kApart = 1 << 9;  // leaves from which halves are built side by side: fewer take less time than handing them out

bool is_before(double squared, std::uint32_t point, double other_squared, std::uint32_t other) {
  return squared < other_squared || (squared == other_squared && point < other);
}

// The k nearest points so far, nearest first, those as far by their index.
class Nearest {
 public:
  Nearest(std::size_t k, std::uint32_t* index, double* squared) : k_(k), index_(index), squared_(squared), reach_(k > 0 ? HUGE_VAL : -1) {}
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double reach() const { return reach_; }
  void add(double squared, std::uint32_t point) {
    if (size_ == k_) {
      if (!is_before(squared, point, squared_[k_ - 1], index_[k_ - 1])) return;
    } else {
      ++size_;
    }
    std::size_t at = size_ - 1;
    for (; at > 0 && is_before(squared, point, squared_[at - 1], index_[at - 1]); --at) {
      squared_[at] = squared_[at - 1];
      index_[at] = index_[at - 1];
    }
    squared_[at] = squared;
    index_[at] = point;
    if (size_ == k_) reach_ = squared_[k_ - 1];
  }

 private:
  std::size_t k_;
  std::uint32_t* index_;
  double* squared_;
  std::size_t size_ = 0;
  double reach_;
};

// The same of many, in any order: the farther half of twice as many is taken out together.
class ManyNearest {
 public:
  explicit ManyNearest(std::size_t k) : k_(k) { found_.reserve(2 * k); }
  [[nodiscard]] double reach() const { return reach_; }
  void add(double squared, std::uint32_t point) {
    found_.emplace_back(squared, point);
    if (found_.size() == 2 * k_) keep_nearest();
  }
  void sort_into(std::uint32_t* index, double* squared) {
    if (found_.size() > k_) keep_nearest();
    std::sort(found_.begin(), found_.end());
    for (const auto& [distance, point] : found_) {
      *index++ = point;
      *squared++ = distance;
    }
  }

 private:
  void keep_nearest() {
    const auto last = found_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(found_.begin(), last, found_.end());
    reach_ = last->first;
    found_.resize(k_);
  }

  std::size_t k_;
  double reach_ = HUGE_VAL;
  std::vector<std::pair<double, std::uint32_t>> found_;  // those as far by their index
};

// The nearest among the points that have a mark.
class NearestMarked : public Nearest {
 public:
  NearestMarked(std::size_t k, const std::vector<std::uint8_t>& marks, std::uint32_t* index, double* squared)
      : Nearest(k, index, squared), marks_(marks) {}
  void add(double squared, std::uint32_t point) {
    if (marks_[point] != 0) Nearest::add(squared, point);
  }

 private:
  const std::vector<std::uint8_t>& marks_;
};

// The nearest point that is nearer than `reach`.
class Nearer {
 public:
  Nearer(double reach, std::uint32_t none) : point_(none), squared_(reach) {}
  [[nodiscard]] std::uint32_t point() const { return point_; }
  [[nodiscard]] double reach() const { return squared_; }
  void add(double squared, std::uint32_t point) {
    if (!(squared < squared_ || (found_ && squared == squared_ && point < point_))) return;
    found_ = true;
    squared_ = squared;
    point_ = point;
  }

 private:
  bool found_ = false;
  std::uint32_t point_;
  double squared_;
};

// All points that are nearer than `reach`, until they are more than `most`.
class Within {
 public:
  Within(double reach, std::size_t most, std::vector<std::uint32_t>& index) : reach_(reach), most_(most), index_(index) {}
  [[nodiscard]] double reach() const { return index_.size() > most_ ? -1 : reach_; }
  void add(double squared, std::uint32_t point) {
    if (squared < reach_) index_.push_back(point);
  }

 private:
  double reach_;
  std::size_t most_;
  std::vector<std::uint32_t>& index_;
};

struct Box {
  Vec3 low, high;
};

}  // namespace

// Balanced: leaves of kLeaf points, but for the last, side by side in `order`; of every node half of the leaves, rounded down, are before
// the cut. So the tree is known by their number, and its inner nodes, parents first, hold the cuts only.
struct Neighbours::Tree {
  // Across `axis`: the last point before the cut and the first one after it.
  struct Cut {
    double before = 0, after = 0;
    std::size_t axis = 0;
  };
  // Leaves [begin, end) and the first of their inner nodes, of which there is one fewer.
  struct Node {
    std::size_t begin, end, first;
    [[nodiscard]] std::size_t leaves() const { return end - begin; }
    [[nodiscard]] std::size_t middle() const { return begin + leaves() / 2; }
    [[nodiscard]] Node before() const { return {begin, middle(), first + 1}; }
    [[nodiscard]] Node after() const { return {middle(), end, first + leaves() / 2}; }
  };

  const std::vector<Vec3>& points;
  std::vector<std::uint32_t> order;
  std::vector<Cut> cuts;
  Box box{};

  explicit Tree(const std::vector<Vec3>& p) : points(p), order(p.size()) {
    std::iota(order.begin(), order.end(), std::uint32_t{0});
    if (order.empty()) return;
    const Node all = root();
    cuts.resize(all.leaves() - 1);
    box = box_of(all);
    cut(all, box);
  }

  [[nodiscard]] Node root() const { return {0, (order.size() + kLeaf - 1) / kLeaf, 0}; }
  [[nodiscard]] std::size_t end_of(const Node& node) const { return std::min(order.size(), node.end * kLeaf); }

  [[nodiscard]] Box box_of(const Node& node) const {
    Box out{points[order[node.begin * kLeaf]], points[order[node.begin * kLeaf]]};
    for (std::size_t i = node.begin * kLeaf; i < end_of(node); ++i) {
      const Vec3& p = points[order[i]];
      for (std::size_t a = 0; a < 3; ++a) {
        out.low[a] = std::min(out.low[a], p[a]);
        out.high[a] = std::max(out.high[a], p[a]);
      }
    }
    return out;
  }

  // Where the points in `around` reach farthest.
  void cut(const Node& node, const Box& around) {
    if (node.leaves() < 2) return;
    const Vec3 extent = vector::subtract(around.high, around.low);
    const auto axis = static_cast<std::size_t>(std::max_element(extent.begin(), extent.end()) - extent.begin());
    const auto place = [this](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto first = place(node.begin * kLeaf), middle = place(node.middle() * kLeaf);
    std::nth_element(first, middle, place(end_of(node)),
                     [&](std::uint32_t i, std::uint32_t j) { return points[i][axis] < points[j][axis]; });
    const std::array<Node, 2> halves = {node.before(), node.after()};
    std::array<Box, 2> boxes{};
    const auto go_on = [&](std::size_t half) {
      boxes[half] = box_of(halves[half]);
      cut(halves[half], boxes[half]);
    };
    if (node.leaves() < kApart) {
      go_on(0);
      go_on(1);
    } else {
      parallel::for_each(halves.size(), go_on);
    }
    cuts[node.first] = {boxes[0].high[axis], boxes[1].low[axis], axis};
  }

  // Nearest points of all on the device of this thread's call; none where that is the processor, or cannot.
  [[nodiscard]] std::vector<std::uint32_t> of_all_there(std::size_t k) const {
    const std::shared_ptr<gpu::Execution> execution = gpu::Execution::current();
    if (execution == nullptr || !execution->usable(true) || !execution->device().rounds_alike() || k == 0 || k > kMostThere) return {};
    const std::size_t count = order.size();
    std::vector<double> places(3 * count);
    parallel::for_all(count, [&](std::size_t i) {
      for (std::size_t a = 0; a < 3; ++a) places[a * count + i] = points[order[i]][a];
    });
    std::vector<double> cuts_there;
    cuts_there.reserve(3 * cuts.size());
    for (const Cut& c : cuts) cuts_there.insert(cuts_there.end(), {c.before, c.after, static_cast<double>(c.axis)});
    std::vector<std::uint32_t> found;
    execution->device().alone([&] {
      try {
        const auto start = std::chrono::steady_clock::now();
        found = gpu::nearest_of_all(execution->device(), {kLeaf, places, order, cuts_there}, k);
        execution->add_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      } catch (const gpu::OutOfMemory&) {  // the sums may fit, in parts
      } catch (const gpu::DeviceError& error) {
        execution->fail(error.what());
      }
    });
    return found;
  }

  // Shows `found` every point that is no farther from x than it still looks, and some others.
  template <class Found>
  void search(const Vec3& x, Found& found) const {
    if (order.empty()) return;
    Vec3 off{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = std::max({box.low[a] - x[a], x[a] - box.high[a], 0.0});
      off[a] = d * d;
    }
    look(root(), x, off, found);
  }

  // `off`: of x from the node's box along every axis, squared. Same order of additions as for points, so that no point is nearer than its
  // box.
  template <class Found>
  void look(const Node& node, const Vec3& x, Vec3& off, Found& found) const {
    if (node.leaves() < 2) {
      // Those near enough are picked without branches: to guess wrong at every other point takes longer than its distance.
      std::array<double, kLeaf> squared;
      std::array<std::uint32_t, kLeaf> index;
      std::size_t count = 0;
      const double reach = found.reach();
      for (std::size_t i = node.begin * kLeaf; i < end_of(node); ++i) {
        const Vec3 d = vector::subtract(points[order[i]], x);
        squared[count] = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        index[count] = order[i];
        count += squared[count] <= reach ? 1 : 0;
      }
      for (std::size_t k = 0; k < count; ++k) {
        if (squared[k] <= found.reach()) found.add(squared[k], index[k]);
      }
      return;
    }
    const Cut& cut = cuts[node.first];
    const double past = x[cut.axis] - cut.before, short_of = cut.after - x[cut.axis];
    const bool is_before_cut = past < short_of;
    look(is_before_cut ? node.before() : node.after(), x, off, found);
    const double d = std::max(is_before_cut ? short_of : past, 0.0), here = off[cut.axis];
    off[cut.axis] = std::max(here, d * d);
    if (!(off[0] + off[1] + off[2] > found.reach())) look(is_before_cut ? node.after() : node.before(), x, off, found);
    off[cut.axis] = here;
  }
};

Neighbours::Neighbours(const std::vector<Vec3>& positions) : tree_(std::make_unique<Tree>(positions)) {}
Neighbours::~Neighbours() = default;

void Neighbours::nearest(const Vec3& x, std::size_t k, std::vector<std::uint32_t>& index, std::vector<double>& squared) const {
  k = std::min(k, tree_->points.size());
  index.resize(k);
  squared.resize(k);
  if (k >= kMany) {
    ManyNearest found(k);
    tree_->search(x, found);
    found.sort_into(index.data(), squared.data());
    return;
  }
  Nearest found(k, index.data(), squared.data());
  tree_->search(x, found);
}

void Neighbours::nearest_marked(const Vec3& x, std::size_t k, const std::vector<std::uint8_t>& marks, std::vector<std::uint32_t>& index,
                                std::vector<double>& squared) const {
  index.resize(k);
  squared.resize(k);
  NearestMarked found(k, marks, index.data(), squared.data());
  tree_->search(x, found);
  index.resize(found.size());
  squared.resize(found.size());
}

std::uint32_t Neighbours::nearest(const Vec3& x, double& squared, std::uint32_t none) const {
  Nearer found(squared, none);
  tree_->search(x, found);
  squared = found.reach();
  return found.point();
}

void Neighbours::within(const Vec3& x, double radius, std::vector<std::uint32_t>& index, std::size_t most) const {
  index.clear();
  Within found(radius * radius, most, index);
  tree_->search(x, found);
}

std::vector<std::uint32_t> Neighbours::of_all(std::size_t k) const {
  const std::vector<Vec3>& points = tree_->points;
  k = std::min(k, points.size());
  std::vector<std::uint32_t> out = tree_->of_all_there(k);
  if (!out.empty()) return out;
  out.resize(points.size() * k);
  parallel::for_blocks(points.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<double> squared(k);
    for (std::size_t i = begin; i < end; ++i) {
      Nearest found(k, out.data() + i * k, squared.data());
      tree_->search(points[i], found);
    }
  });
  return out;
}

}  // namespace g3r
