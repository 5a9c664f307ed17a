// Sources: Greengard and Rokhlin 1997 for the passes; Dehnen 2002 for the traversal.
#include "sum/sum_engine.h"

#include "cpu/parallel.h"
#include "expansions/expansions.h"
#include "gpu/execution.h"
#include "gpu/sum_on_device.h"
#include "kernels/kernels.h"

#include <algorithm>
#include <cmath>

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
SumEngine<T>::SumEngine(Points points, const std::vector<std::uint64_t>& morton, const Widths& widths, const SumPlan& plan,
                        const std::atomic<bool>* cancel)
    : plan_(plan), local_widths_(!widths.uniform()), cancel_(cancel), sources_(std::make_shared<Sources>()) {
  set_terms({plan.order, plan.opening, plan.cut});
  Sources& s = *sources_;
  s.points = std::move(points);
  s.tree = build_octree(*s.points, morton, widths.values, plan_.leaf_points);
  for (std::size_t o = 0; o < 8 && !plan_.direct; ++o) {
    const Vec3 shift{o & 4 ? 0.5 : -0.5, o & 2 ? 0.5 : -0.5, o & 1 ? 0.5 : -0.5};
    const std::vector<double> matrix = multipole_translation(shift, plan_.order);
    s.child_to_parent[o] = StoredTranslation<T>(matrix, coefficients_, false, 1.0);
    s.parent_to_child[o] = StoredTranslation<T>(matrix, coefficients_, true, 0.5);
  }
  target_tree_ = std::shared_ptr<Octree>(sources_, &s.tree);
  locate_sources(widths.values);
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
  locate_sources(narrower.values);
}

template <class T>
SumEngine<T>::SumEngine(const SumEngine& other, const std::vector<Vec3>& targets, const std::vector<std::uint64_t>& morton,
                        const std::atomic<bool>* cancel)
    : plan_(other.plan_),
      local_widths_(other.local_widths_),
      cancel_(cancel),
      sources_(other.sources_),
      source_fields_(other.source_fields_) {
  set_terms({plan_.order, plan_.opening, plan_.cut});
  set_targets(targets, morton);
}

template <class T>
void SumEngine<T>::set_targets(const std::vector<Vec3>& targets, const std::vector<std::uint64_t>& morton) {
  on_device_.reset();
  target_tree_ = std::make_shared<Octree>(build_query_octree(targets, morton, sources_->tree));
  locate_targets(targets, {source_fields_->widths[0]});
  interactions_ = std::make_shared<Interactions>();
}

template <class T>
const TargetBlocks<T>& SumEngine<T>::targets() {
  if (!targets_) locate_targets(*sources_->points, source_fields_->widths);
  return *targets_;
}

template <class T>
void SumEngine<T>::set_terms(const M2lTerms& terms) {
  terms_ = terms;
  coefficients_ = coefficient_count(terms.order);
  stride_ = cpu::padded_count(coefficients_);
}

template <class T>
void SumEngine<T>::locate_sources(const std::vector<double>& widths) {
  const Sources& s = *sources_;
  source_fields_ = std::make_shared<SourceFields>();
  source_fields_->widths = widths;
  AlignedVector<T>& geometry = source_fields_->geometry;
  const std::size_t stride = field_stride();
  geometry.resize(geometry_fields() * stride);
  parallel::for_blocks(s.tree.leaves.size(), kNodeBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const OctreeNode& leaf = s.tree.nodes[s.tree.leaves[i]];
      const Vec3 centre = leaf.centre();
      for (std::size_t p = leaf.begin; p < leaf.end; ++p) {
        for (std::size_t a = 0; a < 3; ++a) geometry[a * stride + p] = static_cast<T>((*s.points)[p][a] - centre[a]);
        if (local_widths_) geometry[3 * stride + p] = static_cast<T>(widths[p] * widths[p]);
      }
    }
  });
}

template <class T>
void SumEngine<T>::locate_targets(const std::vector<Vec3>& targets, const std::vector<double>& target_widths) {
  const Octree& tree = *target_tree_;
  targets_ = std::make_shared<TargetBlocks<T>>();
  TargetBlocks<T>& blocks = *targets_;
  blocks.first_block.assign(1, 0);
  for (const std::uint32_t leaf : tree.leaves) {
    blocks.first_block.push_back(blocks.first_block.back() + (tree.nodes[leaf].count() + cpu::kLanes - 1) / cpu::kLanes);
  }
  const std::size_t lanes = blocks.first_block.back() * cpu::kLanes;
  blocks.point.resize(lanes);
  blocks.x.resize(lanes);
  blocks.y.resize(lanes);
  blocks.z.resize(lanes);
  if (local_widths_) blocks.width_squared.resize(lanes);
  parallel::for_blocks(tree.leaves.size(), kNodeBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const OctreeNode& leaf = tree.nodes[tree.leaves[i]];
      const Vec3 centre = leaf.centre();
      const std::size_t first = blocks.first_block[i] * cpu::kLanes;
      for (std::size_t lane = first; lane < blocks.first_block[i + 1] * cpu::kLanes; ++lane) {
        const std::size_t p = std::min<std::size_t>(leaf.begin + (lane - first), leaf.end - 1);
        blocks.point[lane] = static_cast<std::uint32_t>(p);
        blocks.x[lane] = static_cast<T>(targets[p][0] - centre[0]);
        blocks.y[lane] = static_cast<T>(targets[p][1] - centre[1]);
        blocks.z[lane] = static_cast<T>(targets[p][2] - centre[2]);
        if (local_widths_) blocks.width_squared[lane] = static_cast<T>(target_widths[p] * target_widths[p]);
      }
    }
  });
}

template <class T>
const InteractionLists& SumEngine<T>::lists() {
  std::optional<InteractionLists>& lists = interactions_->lists;
  if (!lists) lists = build_interaction_lists(*target_tree_, sources_->tree, plan_.direct ? 0.0 : plan_.opening, plan_.reach);
  return *lists;
}

template <class T>
const M2lMatrices<T>& SumEngine<T>::matrices() {
  std::vector<std::unique_ptr<M2lMatrices<T>>>& made = interactions_->matrices;
  made.resize(static_cast<std::size_t>(plan_.order) + 1);
  std::unique_ptr<M2lMatrices<T>>& of_order = made[static_cast<std::size_t>(terms_.order)];
  if (!of_order) of_order = std::make_unique<M2lMatrices<T>>(lists().offsets, terms_);
  return *of_order;
}

template <class T>
void SumEngine<T>::begin_values(std::size_t values) {
  multipoles_of_.reset();
  const bool fresh = fields_.empty();
  field_count_ = geometry_fields() + values;
  if (fields_.size() < field_count_ * field_stride()) fields_.resize(field_count_ * field_stride());
  if (fresh) std::copy(source_fields_->geometry.begin(), source_fields_->geometry.end(), fields_.begin());
}

template <class T>
AlignedVector<T>& SumEngine<T>::target_data(std::size_t channels) {
  target_data_.resize(targets().x.size() * channels);
  return target_data_;
}

template <class T>
cpu::LeafTask<T> SumEngine<T>::leaf_task(cpu::NearForm form, int batch, double half_side) const {
  cpu::LeafTask<T> task{};
  task.form = form;
  task.batch = batch;
  task.order = terms_.order;
  task.half_side = static_cast<T>(half_side);
  task.local_widths = local_widths_;
  task.uniform_width_squared = static_cast<T>(source_fields_->widths[0] * source_fields_->widths[0]);
  task.stride = stride_;
  return task;
}

template <class T>
void SumEngine<T>::upward(cpu::NearForm form, int batch) {
  if (multipoles_of_ == form) return;
  const Octree& tree = sources_->tree;
  multipoles_.resize(tree.nodes.size() * multipole_channels_ * stride_);
  parallel::for_blocks(
      tree.leaves.size(), kLeafBlock,
      [&](std::size_t begin, std::size_t end) {
        AlignedVector<T> workspace(cpu::leaf_workspace(coefficients_, multipole_channels_));
        for (std::size_t i = begin; i < end; ++i) {
          const OctreeNode& leaf = tree.nodes[tree.leaves[i]];
          cpu::LeafTask<T> task = leaf_task(form, batch, leaf.half_side());
          task.fields = fields_.data() + leaf.begin;
          task.field_count = field_count_;
          task.field_stride = field_stride();
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
void SumEngine<T>::across(cpu::NearForm form) {
  const InteractionLists& lists = this->lists();
  const Octree& tree = *target_tree_;
  locals_.resize(tree.nodes.size() * local_channels_ * stride_);
  const M2lMatrices<T>& matrices = this->matrices();
  parallel::for_each(
      lists.chunk_begin.size() - 1,
      [&](std::size_t chunk) {
        const std::size_t first = chunk * kTargetChunk;
        const std::size_t last = std::min(first + kTargetChunk, tree.nodes.size());
        std::fill(local(first), local(last - 1) + local_channels_ * stride_, T{0});
        AlignedVector<T> made;
        Moves moves;
        for (std::size_t i = lists.chunk_begin[chunk]; i < lists.chunk_begin[chunk + 1];) {
          const std::size_t index = matrices.index(lists.far[i].offset);
          i = gather(form, matrices, i, lists.chunk_begin[chunk + 1], moves);
          const cpu::TranslationMatrix<T> matrix = matrices.matrix(index, made);
          for (const auto& [moving, some] : {std::pair{cpu::Moved::kAll, &moves.all}, std::pair{cpu::Moved::kStokesForward, &moves.forward},
                                             std::pair{cpu::Moved::kStokesTransposed, &moves.transposed}}) {
            if (!some->empty()) cpu::translate(matrix, some->data(), some->size(), multipole_channels_, stride_, moving);
          }
        }
      },
      cancel_);
}

// The far pairs from `begin` on that share its matrix. Returns the end of them.
template <class T>
std::size_t SumEngine<T>::gather(cpu::NearForm form, const M2lMatrices<T>& matrices, std::size_t begin, std::size_t end, Moves& moves) {
  const InteractionLists& lists = this->lists();
  moves.all.clear();
  moves.forward.clear();
  moves.transposed.clear();
  const std::vector<std::uint32_t>& level_begin = target_tree_->level_begin;
  const std::size_t index = matrices.index(lists.far[begin].offset);
  std::size_t i = begin;
  while (i < end && matrices.index(lists.far[i].offset) == index) {
    const std::uint32_t number = lists.far[i].offset;
    const Offset& offset = lists.offsets[number];
    const T* signs = matrices.signs(offset);
    std::vector<cpu::Translation<T>>& to =
        form != cpu::NearForm::kStokesWinding ? moves.all : (offset.positive() ? moves.forward : moves.transposed);
    std::size_t level = 0;  // of the target; an offset's targets ascend, and nodes are numbered level by level
    std::array<T, 3> move = moved<T>(offset.to_source(level));
    for (; i < end && lists.far[i].offset == number; ++i) {
      const FarPair& pair = lists.far[i];
      if (pair.target >= level_begin[level + 1]) {
        while (pair.target >= level_begin[level + 1]) ++level;
        move = moved<T>(offset.to_source(level));
      }
      to.push_back({multipole(pair.source), local(pair.target), signs, move});
    }
  }
  return i;
}

template <class T>
void SumEngine<T>::downward(cpu::NearForm form) {
  const Octree& tree = *target_tree_;
  const T* unchanged = matrices().signs(Offset());
  for (std::size_t level = 1; level < tree.levels(); ++level) {
    const std::size_t first = tree.level_begin[level];
    parallel::for_blocks(tree.level_begin[level + 1] - first, kNodeBlock, [&](std::size_t begin, std::size_t end) {
      MovesByOctant down;
      for (std::size_t i = first + begin; i < first + end; ++i) {
        const OctreeNode& node = tree.nodes[i];
        const Vec3 move = difference(tree.nodes[node.parent].centre(), node.centre());
        down[octant(node)].push_back({local(node.parent), local(i), unchanged, moved<T>(move)});
      }
      translate_levels(form, sources_->parent_to_child, down, local_channels_);
    });
  }
}

template <class T>
void SumEngine<T>::leaves(cpu::NearForm form, int batch, std::size_t out_channels) {
  const InteractionLists& lists = this->lists();
  const Octree& tree = *target_tree_;
  const Octree& source_tree = sources_->tree;
  const std::size_t data_channels = form == cpu::NearForm::kGreenAdjoint ? static_cast<std::size_t>(batch) : 0;
  parallel::for_blocks(
      tree.leaves.size(), kLeafBlock,
      [&](std::size_t begin, std::size_t end) {
        AlignedVector<T> workspace(std::max(cpu::near_workspace(field_count_), plan_.direct ? 0 : cpu::leaf_workspace(coefficients_, 1)));
        std::vector<cpu::SourceRun<T>> runs;
        for (std::size_t i = begin; i < end; ++i) {
          const OctreeNode& leaf = tree.nodes[tree.leaves[i]];
          const Vec3 centre = leaf.centre();
          runs.clear();
          for (std::size_t k = lists.near_begin[i]; k < lists.near_begin[i + 1]; ++k) {
            const OctreeNode& source = source_tree.nodes[source_tree.leaves[lists.near[k]]];
            const Vec3 shift = difference(source.centre(), centre);
            runs.push_back({source.begin, source.count(), {static_cast<T>(shift[0]), static_cast<T>(shift[1]), static_cast<T>(shift[2])}});
          }
          const std::size_t first = targets_->first_block[i];
          const std::size_t lane = first * cpu::kLanes;
          cpu::NearTask<T> near{};
          near.form = form;
          near.batch = batch;
          near.fields = fields_.data();
          near.stride = field_stride();
          near.runs = runs.data();
          near.run_count = runs.size();
          near.count = leaf.count();
          near.x = targets_->x.data() + lane;
          near.y = targets_->y.data() + lane;
          near.z = targets_->z.data() + lane;
          near.width_squared = local_widths_ ? targets_->width_squared.data() + lane : nullptr;
          near.u = target_data_.data() + lane * data_channels;
          near.uniform_width_squared = static_cast<T>(source_fields_->widths[0] * source_fields_->widths[0]);
          near.local_widths = local_widths_;
          near.reach = static_cast<T>(std::min(plan_.reach, kMollifierReach<T>));
          near.kernel_error = plan_.kernel_error;
          near.out = out_.data() + lane * out_channels;
          near.workspace = workspace.data();
          cpu::near_field(near);
          if (plan_.direct) continue;
          cpu::LeafTask<T> far = leaf_task(form, batch, leaf.half_side());
          far.local = local(tree.leaves[i]);
          far.x = near.x;
          far.y = near.y;
          far.z = near.z;
          far.width_squared = near.width_squared;
          far.u = near.u;
          far.block_count = targets_->first_block[i + 1] - first;
          far.out = near.out;
          far.workspace = workspace.data();
          cpu::local_to_points(far);
        }
      },
      cancel_);
}

template <class T>
bool SumEngine<T>::run_on_device(cpu::NearForm form, int batch, std::size_t out_channels) {
  if (!plan_.execution || !plan_.execution->usable(sizeof(T) == sizeof(double))) return false;
  gpu::Device& device = plan_.execution->device();
  try {
    const std::unique_lock lock = device.lock();
    std::shared_ptr<gpu::ListsOnDevice<T>>& lists = interactions_->on_device;
    if (!lists) lists = std::make_shared<gpu::ListsOnDevice<T>>(device, *target_tree_, sources_->tree, this->lists());
    if (!plan_.direct) {
      lists->prepare_far(matrices(), terms_.order, {sources_->child_to_parent, sources_->parent_to_child}, coefficient_count(plan_.order));
    }
    if (!on_device_) {
      const gpu::PointsOfSum<T> points{source_fields_->geometry.data(),
                                       geometry_fields(),
                                       field_stride(),
                                       targets_->first_block,
                                       targets_->x.data(),
                                       targets_->y.data(),
                                       targets_->z.data(),
                                       local_widths_ ? targets_->width_squared.data() : nullptr,
                                       source_fields_->widths[0]};
      on_device_ = std::make_shared<gpu::SumOnDevice<T>>(device, *lists, *target_tree_, sources_->tree, points);
    }
    const std::size_t data_channels = form == cpu::NearForm::kGreenAdjoint ? static_cast<std::size_t>(batch) : 0;
    const T reach = static_cast<T>(std::min(plan_.reach, kMollifierReach<T>));
    on_device_->run({form, batch, plan_.direct, terms_.order, reach, plan_.kernel_error, value(0), field_count_ - geometry_fields(),
                     target_data_.data(), data_channels, multipole_channels_, local_channels_, out_channels, cancel_},
                    out_);
    return true;
  } catch (const gpu::DeviceError& error) {
    on_device_.reset();
    interactions_->on_device.reset();
    plan_.execution->fail(error.what());
    return false;
  }
}

template <class T>
const std::vector<double>& SumEngine<T>::run(cpu::NearForm form, int batch, std::size_t out_channels) {
  multipole_channels_ = multipole_channels(form, batch, local_widths_);
  local_channels_ = multipole_channels_ + (form == cpu::NearForm::kStokesWinding ? 1 : 0);
  set_terms(terms_for(form, batch, plan_));
  out_.resize(targets().x.size() * out_channels);
  if (run_on_device(form, batch, out_channels)) return out_;
  if (!plan_.direct) {
    upward(form, batch);
    across(form);
    downward(form);
  }
  leaves(form, batch, out_channels);
  return out_;
}

template class SumEngine<float>;
template class SumEngine<double>;

}  // namespace g3r
