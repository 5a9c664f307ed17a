#include "sum/sum_geometry.h"

#include "cloud/morton.h"
#include "cpu/parallel.h"
#include "expansions/expansions.h"

#include <algorithm>
#include <stdexcept>

namespace g3r {
namespace {

constexpr std::size_t kPlacedLeaves = 32;  // leaves per parallel block

// Coordinates relative to the centre of the leaf, where floats keep most of their digits.
template <class T>
AlignedVector<T> places_in(const Octree& tree, const std::vector<Vec3>& points, std::size_t stride) {
  AlignedVector<T> places(3 * stride);
  parallel::for_blocks(tree.leaves.size(), kPlacedLeaves, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const OctreeNode& leaf = tree.nodes[tree.leaves[i]];
      const Vec3 centre = leaf.centre();
      for (std::size_t p = leaf.begin; p < leaf.end; ++p) {
        for (std::size_t a = 0; a < 3; ++a) places[a * stride + p] = static_cast<T>(points[p][a] - centre[a]);
      }
    }
  });
  return places;
}

}  // namespace

template <class T>
SumGeometry<T>::SumGeometry(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan)
    : plan_(plan),
      local_widths_(!widths.uniform()),
      sources_(std::make_shared<Sources>()),
      interactions_(std::make_shared<Interactions>()) {
  Sources& s = *sources_;
  s.count = points.size();
  s.tree = build_octree(points, morton_codes(points), widths.values, plan_.leaf_points);
  s.places = places_in<T>(s.tree, points, source_stride());
  for (std::size_t o = 0; o < 8 && !plan_.direct; ++o) {
    const Vec3 shift{o & 4 ? 0.5 : -0.5, o & 2 ? 0.5 : -0.5, o & 1 ? 0.5 : -0.5};
    const std::vector<double> matrix = multipole_translation(shift, plan_.order);
    s.child_to_parent[o] = StoredTranslation<T>(matrix, coefficient_count(plan_.order), false, 1.0);
    s.parent_to_child[o] = StoredTranslation<T>(matrix, coefficient_count(plan_.order), true, 0.5);
  }
  target_tree_ = std::shared_ptr<Octree>(sources_, &s.tree);
  set_widths(widths);
}

template <class T>
SumGeometry<T>::SumGeometry(const SumGeometry& other, const Widths& narrower)
    : plan_(other.plan_),
      local_widths_(!narrower.uniform()),
      sources_(other.sources_),
      target_tree_(other.target_tree_),
      interactions_(other.interactions_) {
  set_widths(narrower);
  const SourceWidths& wide = *other.widths_;
  for (std::size_t i = 0; i < (local_widths_ || other.local_widths_ ? sources_->count : 1); ++i) {
    const bool is_wider = other.local_widths_ ? static_cast<T>(narrower[i] * narrower[i]) > wide.squared[i] : narrower[i] > wide.uniform;
    if (is_wider) throw std::invalid_argument("a sum that shares a tree has a larger width");
  }
}

template <class T>
SumGeometry<T>::SumGeometry(const SumGeometry& other, const std::vector<Vec3>& targets)
    : plan_(other.plan_), local_widths_(other.local_widths_), sources_(other.sources_), widths_(other.widths_) {
  if (local_widths_ && !other.has_own_targets()) {  // the mean of the square of a source and that of a target, 0, is that of the source
    widths_ = std::make_shared<SourceWidths>(*other.widths_);
    for (T& squared : widths_->squared) squared *= 2;
  }
  set_targets(targets);
}

template <class T>
void SumGeometry<T>::set_targets(const std::vector<Vec3>& targets) {
  target_tree_ = std::make_shared<Octree>(build_query_octree(targets, morton_codes(targets), sources_->tree));
  target_places_ = places_in<T>(*target_tree_, targets, stride_of(targets.size()));
  if (local_widths_) target_places_.resize(4 * stride_of(targets.size()), T{0});
  interactions_ = std::make_shared<Interactions>();
}

template <class T>
void SumGeometry<T>::set_widths(const Widths& widths) {
  widths_ = std::make_shared<SourceWidths>();
  widths_->uniform = widths[0];
  if (!local_widths_) return;
  AlignedVector<T>& squared = widths_->squared;
  squared.resize(source_stride());
  std::transform(widths.values.begin(), widths.values.end(), squared.begin(), [](double width) { return static_cast<T>(width * width); });
}

template <class T>
const InteractionLists& SumGeometry<T>::lists() {
  std::optional<InteractionLists>& lists = interactions_->lists;
  if (!lists) lists = build_interaction_lists(*target_tree_, sources_->tree, plan_.direct ? 0.0 : plan_.opening, plan_.reach);
  return *lists;
}

template <class T>
const M2lMatrices<T>& SumGeometry<T>::matrices(const M2lTerms& terms) {
  std::vector<std::unique_ptr<M2lMatrices<T>>>& made = interactions_->matrices;
  made.resize(static_cast<std::size_t>(plan_.order) + 1);
  std::unique_ptr<M2lMatrices<T>>& of_order = made[static_cast<std::size_t>(terms.order)];
  if (!of_order) of_order = std::make_unique<M2lMatrices<T>>(lists().offsets, terms);
  return *of_order;
}

template class SumGeometry<float>;
template class SumGeometry<double>;

}  // namespace g3r
