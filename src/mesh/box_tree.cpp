#include "mesh/box_tree.h"

#include "cpu/parallel.h"
#include "mesh/constants.h"

namespace g3r::mesh {
namespace {

// The levels that are split one after the other: below, every subtree is a job.
constexpr int kTop = std::countr_zero(kTasks);

// A box while the tree is built.
struct Item {
  std::array<float, 3> twice_centre;
  std::uint32_t box;
};

// Puts the smaller half first, along the longest side of the box of centres.
void halve(std::vector<Item>& items, std::size_t begin, std::size_t middle, std::size_t end) {
  FloatBox centres;
  for (std::size_t i = begin; i < end; ++i) centres.extend({items[i].twice_centre, items[i].twice_centre});
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (centres.high[k] - centres.low[k] > centres.high[axis] - centres.low[axis]) axis = k;
  }
  const auto at = [&](std::size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](const Item& s, const Item& t) {
    return s.twice_centre[axis] != t.twice_centre[axis] ? s.twice_centre[axis] < t.twice_centre[axis] : s.box < t.box;
  });
}

}  // namespace

BoxTree::BoxTree(std::vector<FloatBox> boxes) : order_(boxes.size()) {
  std::vector<Item> items(boxes.size());
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) items[i].twice_centre[k] = boxes[i].low[k] + boxes[i].high[k];
    items[i].box = i;
  }
  while (items.size() > kLeafSize << static_cast<unsigned>(levels_)) ++levels_;
  const auto split = [&](int level, std::size_t k) { halve(items, begin(level, k), begin(level + 1, 2 * k + 1), begin(level, k + 1)); };
  const int top = std::min(levels_, kTop);
  for (int level = 0; level < top; ++level) {
    parallel::for_each(std::size_t{1} << static_cast<unsigned>(level), [&](std::size_t k) { split(level, k); });
  }
  parallel::for_each(std::size_t{1} << static_cast<unsigned>(top), [&](std::size_t subtree) {
    for (int level = top; level < levels_; ++level) {
      const auto below = static_cast<unsigned>(level - top);
      for (std::size_t k = subtree << below; k < (subtree + 1) << below; ++k) split(level, k);
    }
  });
  for (std::size_t i = 0; i < items.size(); ++i) order_[i] = items[i].box;
  std::vector<Item>().swap(items);  // not all at once in memory
  boxes_.reserve(order_.size());
  for (const std::uint32_t i : order_) boxes_.push_back(boxes[i]);
  std::vector<FloatBox>().swap(boxes);
  const std::size_t leaves = std::size_t{1} << static_cast<unsigned>(levels_);
  nodes_.resize(2 * leaves - 1);
  for (std::size_t k = 0; k < leaves; ++k) {
    for (std::size_t i = begin(levels_, k); i < begin(levels_, k + 1); ++i) nodes_[leaves - 1 + k].extend(boxes_[i]);
  }
  for (std::size_t node = leaves - 1; node-- > 0;) {
    nodes_[node].extend(nodes_[2 * node + 1]);
    nodes_[node].extend(nodes_[2 * node + 2]);
  }
}

std::vector<BoxTree::PairJob> BoxTree::pair_jobs() const {
  std::vector<PairJob> jobs{{0, 0}};
  bool split = true;
  while (split && jobs.size() < kTasks) {
    std::vector<PairJob> next;
    split = false;
    for (const PairJob& job : jobs) {
      if (is_leaf(job.a) && is_leaf(job.b)) {
        next.push_back(job);
        continue;
      }
      split = true;
      for_each_part(job, [&](const PairJob& part) { next.push_back(part); });
    }
    jobs = std::move(next);
  }
  return jobs;
}

}  // namespace g3r::mesh
