// Sources: Greengard and Rokhlin 1997 for the passes; Dehnen 2002 for the traversal.
#include "sum/sum_engine.h"

#include "cloud/canonical_cloud.h"
#include "cpu/parallel.h"
#include "expansions/expansions.h"
#include "gpu/execution.h"
#include "gpu/sum_on_device.h"
#include "kernels/kernels.h"

#include <g3r/error.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace g3r {
namespace {

constexpr std::size_t kLeafBlock = 4;   // leaves per parallel block
constexpr std::size_t kNodeBlock = 32;  // nodes per parallel block
constexpr int kLeastOrder = 2;          // with order 1 gradients would be constant in a cube
constexpr double kFewerTermsCut = 0.3;  // of the forms of one order less: at 1 they err by half more than the Stokeslets

std::size_t multipole_channels(cpu::NearForm form, int batch, bool local_widths) {
  switch (form) {
    case cpu::NearForm::kGreen:
    case cpu::NearForm::kGreenAdjoint:
      return static_cast<std::size_t>(batch);
    case cpu::NearForm::kStokesWinding:
      return cpu::kStokesMultipoles + (local_widths ? 1 : 0);
    case cpu::NearForm::kWinding:
    case cpu::NearForm::kWindingAdjoint:
    case cpu::NearForm::kWindingGradient:
      return 1;
  }
  return 0;
}

// What kernels are given of every target.
std::size_t target_channels(cpu::NearForm form, int batch) {
  return form == cpu::NearForm::kGreenAdjoint ? static_cast<std::size_t>(batch) : 0;
}

std::size_t blocks_of(const OctreeNode& leaf) { return (leaf.count() + cpu::kLanes - 1) / cpu::kLanes; }

Vec3 difference(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

std::size_t octant(const OctreeNode& node) {
  return static_cast<std::size_t>((node.cell[0] & 1) * 4 + (node.cell[1] & 1) * 2 + (node.cell[2] & 1));
}

// Stokeslets multiply potentials by coordinates and need more terms than the other forms for the same error; measured over the clouds of
// fast_sum_test. An operator and its adjoint share the terms: kWindingAdjoint is that of the W in kStokesWinding too.
M2lTerms terms_for(cpu::NearForm form, int batch, const SumPlan& plan) {
  const bool green = form == cpu::NearForm::kGreen || form == cpu::NearForm::kGreenAdjoint;
  const bool fewer = form == cpu::NearForm::kWindingGradient || (green && batch > 1);
  if (!fewer || plan.order <= kLeastOrder) return {plan.order, plan.opening, plan.cut};
  return {plan.order - 1, plan.opening, kFewerTermsCut * plan.cut};
}

template <class T>
std::array<T, 3> moved(const Vec3& v) {
  return {static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2])};
}

}  // namespace

template <class T>
SumEngine<T>::SumEngine(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan, const std::atomic<bool>* cancel)
    : plan_(plan), local_widths_(!widths.uniform()), cancel_(cancel), sources_(std::make_shared<Sources>()) {
  set_terms({plan.order, plan.opening, plan.cut});
  Sources& s = *sources_;
  s.count = points.size();
  s.tree = build_octree(points, morton_codes(points), widths.values, plan_.leaf_points);
  s.places = places_in(s.tree, points);
  for (std::size_t o = 0; o < 8 && !plan_.direct; ++o) {
    const Vec3 shift{o & 4 ? 0.5 : -0.5, o & 2 ? 0.5 : -0.5, o & 1 ? 0.5 : -0.5};
    const std::vector<double> matrix = multipole_translation(shift, plan_.order);
    s.child_to_parent[o] = StoredTranslation<T>(matrix, coefficients_, false, 1.0);
    s.parent_to_child[o] = StoredTranslation<T>(matrix, coefficients_, true, 0.5);
  }
  target_tree_ = std::shared_ptr<Octree>(sources_, &s.tree);
  set_widths(widths);
  interactions_ = std::make_shared<Interactions>();
}

template <class T>
SumEngine<T>::SumEngine(const SumEngine& other, const Widths& narrower)
    : plan_(other.plan_),
      local_widths_(!narrower.uniform()),
      cancel_(other.cancel_),
      sources_(other.sources_),
      target_tree_(other.target_tree_),
      interactions_(other.interactions_) {
  set_terms({plan_.order, plan_.opening, plan_.cut});
  set_widths(narrower);
  const SourceWidths& wide = *other.source_widths_;
  for (std::size_t i = 0; i < (local_widths_ || other.local_widths_ ? sources_->count : 1); ++i) {
    const bool is_wider = other.local_widths_ ? static_cast<T>(narrower[i] * narrower[i]) > wide.squared[i] : narrower[i] > wide.uniform;
    if (is_wider) throw std::invalid_argument("a sum that shares a tree has a larger width");
  }
}

template <class T>
SumEngine<T>::SumEngine(const SumEngine& other, const std::vector<Vec3>& targets, const std::atomic<bool>* cancel)
    : plan_(other.plan_),
      local_widths_(other.local_widths_),
      cancel_(cancel),
      sources_(other.sources_),
      source_widths_(other.source_widths_) {
  set_terms({plan_.order, plan_.opening, plan_.cut});
  set_targets(targets);
}

template <class T>
void SumEngine<T>::set_targets(const std::vector<Vec3>& targets) {
  on_device_.reset();
  target_tree_ = std::make_shared<Octree>(build_query_octree(targets, morton_codes(targets), sources_->tree));
  target_places_ = places_in(*target_tree_, targets);
  interactions_ = std::make_shared<Interactions>();
}

template <class T>
void SumEngine<T>::set_terms(const M2lTerms& terms) {
  terms_ = terms;
  coefficients_ = coefficient_count(terms.order);
  stride_ = cpu::padded_count(coefficients_);
}

template <class T>
void SumEngine<T>::set_widths(const Widths& widths) {
  source_widths_ = std::make_shared<SourceWidths>();
  source_widths_->uniform = widths[0];
  if (!local_widths_) return;
  AlignedVector<T>& squared = source_widths_->squared;
  squared.resize(source_stride());
  std::transform(widths.values.begin(), widths.values.end(), squared.begin(), [](double width) { return static_cast<T>(width * width); });
}

template <class T>
auto SumEngine<T>::places_in(const Octree& tree, const std::vector<Vec3>& points) const -> Places {
  const std::size_t stride = stride_of(points.size());
  Places places(3 * stride);
  parallel::for_blocks(tree.leaves.size(), kNodeBlock, [&](std::size_t begin, std::size_t end) {
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

template <class T>
void SumEngine<T>::resize(Blocks& blocks, std::size_t count, std::size_t data_channels) const {
  const std::size_t lanes = count * cpu::kLanes;
  for (AlignedVector<T>* field : {&blocks.x, &blocks.y, &blocks.z}) field->resize(lanes);
  if (local_widths_) blocks.width_squared.resize(lanes);
  blocks.data.resize(lanes * data_channels);
}

template <class T>
void SumEngine<T>::place(const OctreeNode& leaf, std::size_t data_channels, Blocks& blocks) const {
  const T* places = (target_places_.empty() ? sources_->places : target_places_).data();
  const std::size_t stride = target_stride();
  for (std::size_t lane = 0; lane < blocks_of(leaf) * cpu::kLanes; ++lane) {
    const std::size_t p = std::min<std::size_t>(leaf.begin + lane, leaf.end - 1);
    blocks.x[lane] = places[p];
    blocks.y[lane] = places[stride + p];
    blocks.z[lane] = places[2 * stride + p];
    if (local_widths_) blocks.width_squared[lane] = source_widths_->squared[p];
    for (std::size_t k = 0; k < data_channels; ++k) {
      blocks.data[(lane / cpu::kLanes * data_channels + k) * cpu::kLanes + lane % cpu::kLanes] = target_values_[k * stride + p];
    }
  }
}

template <class T>
const InteractionLists& SumEngine<T>::lists() {
  std::optional<InteractionLists>& lists = interactions_->lists;
  if (!lists) lists = build_interaction_lists(*target_tree_, sources_->tree, plan_.direct ? 0.0 : plan_.opening, plan_.reach);
  return *lists;
}

template <class T>
const M2lMatrices<T>& SumEngine<T>::make_matrices() {
  std::vector<std::unique_ptr<M2lMatrices<T>>>& made = interactions_->matrices;
  made.resize(static_cast<std::size_t>(plan_.order) + 1);
  std::unique_ptr<M2lMatrices<T>>& of_order = made[static_cast<std::size_t>(terms_.order)];
  if (!of_order) of_order = std::make_unique<M2lMatrices<T>>(lists().offsets, terms_);
  return *of_order;
}

template <class T>
void SumEngine<T>::begin_values(std::size_t values) {
  multipoles_of_.reset();
  value_count_ = values;
  if (values_.size() < values * source_stride()) {
    values_ = AlignedVector<T>();  // not twice in memory
    values_.resize(values * source_stride());
  }
}

template <class T>
cpu::LeafTask<T> SumEngine<T>::leaf_task(cpu::NearForm form, int batch, double half_side) const {
  cpu::LeafTask<T> task{};
  task.form = form;
  task.batch = batch;
  task.order = terms_.order;
  task.half_side = static_cast<T>(half_side);
  task.local_widths = local_widths_;
  task.uniform_width_squared = static_cast<T>(source_widths_->uniform * source_widths_->uniform);
  task.stride = stride_;
  return task;
}

template <class T>
void SumEngine<T>::upward(cpu::NearForm form, int batch) {
  if (multipoles_of_ == form) return;
  const Octree& tree = sources_->tree;
  if (multipoles_.size() < tree.nodes.size() * multipole_channels_ * stride_) {
    multipoles_ = AlignedVector<T>();  // not twice in memory
    multipoles_.resize(tree.nodes.size() * multipole_channels_ * stride_);
  }
  parallel::for_blocks(
      tree.leaves.size(), kLeafBlock,
      [&](std::size_t begin, std::size_t end) {
        AlignedVector<T> workspace(cpu::leaf_workspace(coefficients_, multipole_channels_));
        for (std::size_t i = begin; i < end; ++i) {
          const OctreeNode& leaf = tree.nodes[tree.leaves[i]];
          cpu::LeafTask<T> task = leaf_task(form, batch, leaf.half_side());
          task.places = sources_->places.data() + leaf.begin;
          task.source_width_squared = local_widths_ ? source_widths_->squared.data() + leaf.begin : nullptr;
          task.values = values_.data() + leaf.begin;
          task.value_count = value_count_;
          task.field_stride = source_stride();
          task.count = leaf.count();
          task.channels = multipole_channels_;
          task.multipole = multipole(tree.leaves[i]);
          task.workspace = workspace.data();
          cpu::points_to_multipole(task);
        }
      },
      cancel_);
  const T* unchanged = matrices().signs(Offset());
  for (std::size_t level = tree.levels(); level-- > 0;) {
    const std::size_t first = tree.level_begin[level];
    parallel::for_blocks(tree.level_begin[level + 1] - first, kNodeBlock, [&](std::size_t begin, std::size_t end) {
      MovesByOctant up;
      for (std::size_t i = first + begin; i < first + end; ++i) {
        const OctreeNode& node = tree.nodes[i];
        if (node.leaf()) continue;
        std::fill_n(multipole(i), multipole_channels_ * stride_, T{0});
        for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
          const Vec3 move = difference(tree.nodes[c].centre(), node.centre());
          up[octant(tree.nodes[c])].push_back({multipole(c), multipole(i), unchanged, moved<T>(move)});
        }
      }
      translate_levels(form, sources_->child_to_parent, up, multipole_channels_);
    });
  }
  multipoles_of_ = form;
}

// Children ascend by octant, so each parent is added to in the order of its children.
template <class T>
void SumEngine<T>::translate_levels(cpu::NearForm form, const std::array<StoredTranslation<T>, 8>& matrices, const MovesByOctant& moves,
                                    std::size_t channels) const {
  const cpu::Moved moving = form == cpu::NearForm::kStokesWinding ? cpu::Moved::kStokes : cpu::Moved::kAll;
  for (std::size_t o = 0; o < moves.size(); ++o) {
    if (!moves[o].empty()) {
      cpu::translate(matrices[o].first(coefficients_), moves[o].data(), moves[o].size(), channels, stride_, moving);
    }
  }
}

template <class T>
void SumEngine<T>::across(cpu::NearForm form, std::size_t part, T* locals) {
  const InteractionLists& lists = *interactions_->lists;
  const M2lMatrices<T>& matrices = this->matrices();
  AlignedVector<T> made;
  Moves moves;
  const FarPair* pair = lists.far.data() + lists.far_begin[part];
  for (std::size_t run = lists.run_begin[part]; run < lists.run_begin[part + 1];) {
    const std::size_t index = matrices.index(lists.runs[run].offset);
    run = gather(form, matrices, run, lists.run_begin[part + 1], pair, locals, moves);
    const cpu::TranslationMatrix<T> matrix = matrices.matrix(index, made);
    for (const auto& [moving, some] : {std::pair{cpu::Moved::kAll, &moves.all}, std::pair{cpu::Moved::kStokesForward, &moves.forward},
                                       std::pair{cpu::Moved::kStokesTransposed, &moves.transposed}}) {
      if (!some->empty()) cpu::translate(matrix, some->data(), some->size(), multipole_channels_, stride_, moving);
    }
  }
}

// The runs of far pairs from `begin` on that share its matrix. Returns the end of them, and `pair` is that of their pairs.
template <class T>
std::size_t SumEngine<T>::gather(cpu::NearForm form, const M2lMatrices<T>& matrices, std::size_t begin, std::size_t end,
                                 const FarPair*& pair, T* locals, Moves& moves) {
  const InteractionLists& lists = *interactions_->lists;
  moves.all.clear();
  moves.forward.clear();
  moves.transposed.clear();
  const std::vector<std::uint32_t>& level_begin = target_tree_->level_begin;
  const std::size_t index = matrices.index(lists.runs[begin].offset);
  std::size_t run = begin;
  for (; run < end && matrices.index(lists.runs[run].offset) == index; ++run) {
    const Offset& offset = lists.offsets[lists.runs[run].offset];
    const T* signs = matrices.signs(offset);
    std::vector<cpu::Translation<T>>& to =
        form != cpu::NearForm::kStokesWinding ? moves.all : (offset.positive() ? moves.forward : moves.transposed);
    std::size_t level = 0;  // of the target; an offset's targets ascend, and nodes are numbered level by level
    std::array<T, 3> move = moved<T>(offset.to_source(level));
    for (const FarPair* run_end = pair + lists.runs[run].pairs; pair != run_end; ++pair) {
      if (pair->target >= level_begin[level + 1]) {
        while (pair->target >= level_begin[level + 1]) ++level;
        move = moved<T>(offset.to_source(level));
      }
      T* local = locals + lists.parts.slot[pair->target] * local_channels_ * stride_;
      to.push_back({multipole(pair->source), local, signs, move});
    }
  }
  return run;
}

template <class T>
struct SumEngine<T>::LeafSpace {
  explicit LeafSpace(const SumEngine& engine)
      : workspace(std::max(cpu::near_workspace((engine.local_widths_ ? 4 : 3) + engine.value_count_),
                           engine.plan_.direct ? 0 : cpu::leaf_workspace(engine.coefficients_, 1))) {}
  AlignedVector<T> workspace;
  std::vector<cpu::SourceRun<T>> runs;
  Blocks blocks;
  std::vector<double> out;
};

template <class T>
template <class At>
void SumEngine<T>::downward(cpu::NearForm form, const std::uint32_t* begin, const std::uint32_t* end, const At& at) {
  const Octree& tree = *target_tree_;
  const T* unchanged = matrices().signs(Offset());
  MovesByOctant down;
  for (const std::uint32_t* i = begin; i != end; ++i) {
    const OctreeNode& node = tree.nodes[*i];
    const Vec3 move = difference(tree.nodes[node.parent].centre(), node.centre());
    down[octant(node)].push_back({at(node.parent), at(*i), unchanged, moved<T>(move)});
  }
  translate_levels(form, sources_->parent_to_child, down, local_channels_);
}

// Local expansions of the nodes above all subtrees, by their slots.
template <class T>
AlignedVector<T> SumEngine<T>::locals_above(cpu::NearForm form) {
  const TreeParts& parts = lists().parts;
  const std::size_t each = local_channels_ * stride_;
  AlignedVector<T> locals(parts.above.size() * each);
  parallel::for_each(
      parts.size() - parts.roots.size(), [&](std::size_t k) { across(form, parts.roots.size() + k, locals.data()); }, cancel_);
  const std::vector<OctreeNode>& nodes = target_tree_->nodes;
  for (auto begin = parts.above.begin(); begin != parts.above.end();) {
    const auto end = std::find_if(begin, parts.above.end(), [&](std::uint32_t i) { return nodes[i].level > nodes[*begin].level; });
    if (*begin != 0)
      downward(form, &*begin, &*begin + (end - begin), [&](std::uint32_t i) { return locals.data() + parts.slot[i] * each; });
    begin = end;
  }
  return locals;
}

// The local expansions of a subtree, and the sums at its leaves.
template <class T>
void SumEngine<T>::subtree(cpu::NearForm form, int batch, std::size_t out_channels, std::size_t part, AlignedVector<T>& above,
                           const Take& take) {
  const Octree& tree = *target_tree_;
  const TreeParts& parts = interactions_->lists->parts;
  const std::size_t each = local_channels_ * stride_;
  std::vector<std::uint32_t> members{parts.roots[part]};
  std::vector<std::size_t> level_begin{0};
  for (std::size_t begin = 0; begin < members.size();) {
    const std::size_t end = members.size();
    level_begin.push_back(end);
    for (; begin < end; ++begin) {
      const OctreeNode& node = tree.nodes[members[begin]];
      for (std::uint32_t c = 0; c < node.child_count; ++c) members.push_back(node.first_child + c);
    }
  }
  AlignedVector<T> locals(members.size() * each);
  across(form, part, locals.data());
  const OctreeNode& root = tree.nodes[parts.roots[part]];
  const auto at = [&](std::uint32_t i) { return (parts.part_of[i] == part ? locals : above).data() + parts.slot[i] * each; };
  for (std::size_t level = root.level > 0 ? 0 : 1; level + 1 < level_begin.size(); ++level) {
    downward(form, members.data() + level_begin[level], members.data() + level_begin[level + 1], at);
  }
  const auto leaf_from = [&](std::uint32_t point) {
    const auto before = [&](std::uint32_t leaf, std::uint32_t p) { return tree.nodes[leaf].begin < p; };
    return static_cast<std::size_t>(std::lower_bound(tree.leaves.begin(), tree.leaves.end(), point, before) - tree.leaves.begin());
  };
  const std::size_t first = leaf_from(root.begin);
  parallel::for_blocks(leaf_from(root.end) - first, kLeafBlock, [&](std::size_t begin, std::size_t end) {  // small clouds are one part
    LeafSpace space(*this);
    for (std::size_t i = first + begin; i < first + end; ++i) leaf(form, batch, out_channels, i, at(tree.leaves[i]), space, take);
  });
}

template <class T>
void SumEngine<T>::leaf(cpu::NearForm form, int batch, std::size_t out_channels, std::size_t number, const T* local, LeafSpace& space,
                        const Take& take) {
  const InteractionLists& lists = *interactions_->lists;
  const Octree& source_tree = sources_->tree;
  const OctreeNode& leaf = target_tree_->nodes[target_tree_->leaves[number]];
  const Vec3 centre = leaf.centre();
  space.runs.clear();
  for (std::size_t k = lists.near_begin[number]; k < lists.near_begin[number + 1]; ++k) {
    const OctreeNode& source = source_tree.nodes[source_tree.leaves[lists.near[k]]];
    const Vec3 shift = difference(source.centre(), centre);
    space.runs.push_back({source.begin, source.count(), {static_cast<T>(shift[0]), static_cast<T>(shift[1]), static_cast<T>(shift[2])}});
  }
  const std::size_t count = blocks_of(leaf);
  Blocks& blocks = space.blocks;
  resize(blocks, count, target_channels(form, batch));
  place(leaf, target_channels(form, batch), blocks);
  space.out.resize(count * cpu::kLanes * out_channels);
  cpu::NearTask<T> near{};
  near.form = form;
  near.batch = batch;
  near.places = sources_->places.data();
  near.source_width_squared = source_widths_->squared.data();
  near.values = values_.data();
  near.stride = source_stride();
  near.runs = space.runs.data();
  near.run_count = space.runs.size();
  near.count = leaf.count();
  near.x = blocks.x.data();
  near.y = blocks.y.data();
  near.z = blocks.z.data();
  near.width_squared = local_widths_ ? blocks.width_squared.data() : nullptr;
  near.u = blocks.data.data();
  near.uniform_width_squared = static_cast<T>(source_widths_->uniform * source_widths_->uniform);
  near.local_widths = local_widths_;
  near.reach = static_cast<T>(std::min(plan_.reach, kMollifierReach<T>));
  near.kernel_error = plan_.kernel_error;
  near.out = space.out.data();
  near.workspace = space.workspace.data();
  cpu::near_field(near);
  if (!plan_.direct) {
    cpu::LeafTask<T> far = leaf_task(form, batch, leaf.half_side());
    far.local = local;
    far.x = near.x;
    far.y = near.y;
    far.z = near.z;
    far.width_squared = near.width_squared;
    far.u = near.u;
    far.block_count = count;
    far.out = near.out;
    far.workspace = space.workspace.data();
    cpu::local_to_points(far);
  }
  take(leaf.begin, leaf.count(), space.out.data());
}

template <class T>
bool SumEngine<T>::run_on_device(cpu::NearForm form, int batch, std::size_t out_channels, const Take& take) {
  if (!plan_.execution || !plan_.execution->usable(sizeof(T) == sizeof(double))) return false;
  gpu::Device& device = plan_.execution->device();
  std::atomic<bool> taken = false;
  const auto take_some = [&](std::size_t first, std::size_t count, const T* sums) {
    taken = true;
    std::vector<double> block(out_channels * cpu::kLanes);
    for (std::size_t done = 0; done < count; done += cpu::kLanes, sums += block.size()) {
      std::copy_n(sums, block.size(), block.begin());
      take(static_cast<std::uint32_t>(first + done), static_cast<std::uint32_t>(std::min(cpu::kLanes, count - done)), block.data());
    }
  };
  try {
    const std::unique_lock lock = device.lock();
    std::shared_ptr<gpu::ListsOnDevice<T>>& lists = interactions_->on_device;
    if (!lists) lists = std::make_shared<gpu::ListsOnDevice<T>>(device, *target_tree_, sources_->tree, this->lists());
    if (!plan_.direct) {
      lists->prepare_far(make_matrices(), terms_.order, {sources_->child_to_parent, sources_->parent_to_child},
                         coefficient_count(plan_.order));
    }
    if (!on_device_) {
      const gpu::PointsOfSum<T> points{sources_->places.data(), local_widths_ ? source_widths_->squared.data() : nullptr,
                                       source_stride(),         target_places_.empty() ? nullptr : target_places_.data(),
                                       target_stride(),         source_widths_->uniform};
      on_device_ = std::make_shared<gpu::SumOnDevice<T>>(device, *lists, *target_tree_, sources_->tree, points);
    }
    const T reach = static_cast<T>(std::min(plan_.reach, kMollifierReach<T>));
    const auto start = std::chrono::steady_clock::now();
    on_device_->run({form, batch, plan_.direct, terms_.order, reach, plan_.kernel_error, value(0), value_count_, target_values_.data(),
                     target_channels(form, batch), multipole_channels_, local_channels_, out_channels, cancel_},
                    take_some);
    plan_.execution->add_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  } catch (const gpu::DeviceError& error) {
    on_device_.reset();
    interactions_->on_device.reset();
    plan_.execution->fail(error.what());
    if (taken) throw Unavailable(plan_.execution->failure() + ", while its results were read; --device cpu does without it");
    return false;
  }
  return true;
}

template <class T>
void SumEngine<T>::run(cpu::NearForm form, int batch, std::size_t out_channels, const Take& take) {
  multipole_channels_ = multipole_channels(form, batch, local_widths_);
  local_channels_ = multipole_channels_ + (form == cpu::NearForm::kStokesWinding ? 1 : 0);
  set_terms(terms_for(form, batch, plan_));
  if (run_on_device(form, batch, out_channels, take)) return;
  const InteractionLists& lists = this->lists();
  if (plan_.direct) {
    parallel::for_blocks(
        target_tree_->leaves.size(), kLeafBlock,
        [&](std::size_t begin, std::size_t end) {
          LeafSpace space(*this);
          for (std::size_t i = begin; i < end; ++i) leaf(form, batch, out_channels, i, nullptr, space, take);
        },
        cancel_);
    return;
  }
  (void)make_matrices();
  upward(form, batch);
  AlignedVector<T> above = locals_above(form);
  parallel::for_each(
      lists.parts.roots.size(), [&](std::size_t part) { subtree(form, batch, out_channels, part, above, take); }, cancel_);
}

template class SumEngine<float>;
template class SumEngine<double>;

}  // namespace g3r
