#include "cloud/neighbours.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/vector.h"
#include "cloud/found_points.h"
#include "cpu/parallel.h"
#include "gpu/execution.h"
#include "gpu/neighbours_on_device.h"

namespace g3r {
namespace {

// These decide on time alone.
// A leaf has at most so many points: fewer make more nodes, of more most are looked at in vain.
constexpr std::size_t kLeaf = 16;
// A device looks for so many nearest points at most, as it keeps them in registers.
constexpr std::size_t kMostThere = 64;
// From so many nearest points on it is faster to sort them at the end than to keep them sorted.
constexpr std::size_t kMany = 128;
// From so many leaves on the halves of a node are built by two threads: of fewer, to hand them out takes longer.
constexpr std::size_t kApart = 1 << 9;

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
  vector::Box box;

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

  [[nodiscard]] vector::Box box_of(const Node& node) const {
    vector::Box out;
    for (std::size_t i = node.begin * kLeaf; i < end_of(node); ++i) out.extend(points[order[i]]);
    return out;
  }

  // Cuts a node, whose points fill the box `around`, across the longest side of that.
  void cut(const Node& node, const vector::Box& around) {
    if (node.leaves() < 2) return;
    const Vec3 extent = vector::subtract(around.high, around.low);
    const auto axis = static_cast<std::size_t>(std::max_element(extent.begin(), extent.end()) - extent.begin());
    const auto place = [this](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto first = place(node.begin * kLeaf), middle = place(node.middle() * kLeaf);
    std::nth_element(first, middle, place(end_of(node)),
                     [&](std::uint32_t i, std::uint32_t j) { return points[i][axis] < points[j][axis]; });
    const std::array<Node, 2> halves = {node.before(), node.after()};
    std::array<vector::Box, 2> boxes;
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

  // Neighbours::of_all() on the device of this thread's call; empty where that is the processor, or a device that cannot.
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

  // Adds to `found`, one of the classes of found_points.h, all points that are no farther from x than its reach, and some others.
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
    ManyNearestPoints found(k);
    tree_->search(x, found);
    found.sort_into(index.data(), squared.data());
    return;
  }
  NearestPoints found(k, index.data(), squared.data());
  tree_->search(x, found);
}

void Neighbours::nearest_marked(const Vec3& x, std::size_t k, const std::vector<std::uint8_t>& marks, std::vector<std::uint32_t>& index,
                                std::vector<double>& squared) const {
  index.resize(k);
  squared.resize(k);
  NearestMarkedPoints found(k, marks, index.data(), squared.data());
  tree_->search(x, found);
  index.resize(found.size());
  squared.resize(found.size());
}

bool Neighbours::any_within(const Vec3& x, double distance) const {
  double squared = distance * distance;
  return nearest(x, squared, UINT32_MAX) != UINT32_MAX;
}

std::uint32_t Neighbours::nearest(const Vec3& x, double& squared, std::uint32_t none) const {
  NearestWithin found(squared, none);
  tree_->search(x, found);
  squared = found.reach();
  return found.point();
}

void Neighbours::within(const Vec3& x, double radius, std::vector<std::uint32_t>& index, std::size_t most) const {
  index.clear();
  AllWithin found(radius * radius, most, index);
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
      NearestPoints found(k, out.data() + i * k, squared.data());
      tree_->search(points[i], found);
    }
  });
  return out;
}

}  // namespace g3r
