// Sources: Greengard and Rokhlin 1997 for the passes; Dehnen 2002 for the traversal.
#include "sum/sum_engine.h"

#include "cpu/parallel.h"
#include "sum/expansions.h"
#include "sum/kernels.h"

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

constexpr std::size_t kLeafBlock = 4;                 // leaves per parallel block
constexpr std::size_t kNodeBlock = 32;                // nodes per parallel block
constexpr std::size_t kKeptMatrixBytes = 128u << 20;  // M2L matrices kept in memory up to this; beyond, made when needed

std::size_t multipole_channels(cpu::NearForm form, int batch, bool local_widths) {
  switch (form) {
    case cpu::NearForm::kGreen:
    case cpu::NearForm::kGreenAdjoint:
      return static_cast<std::size_t>(batch);
    case cpu::NearForm::kStokesWinding:
      return cpu::kStokesMultipoles + (local_widths ? 1 : 0);
    case cpu::NearForm::kWindingGradient:
      return 1;
  }
  return 0;
}

// A row-major n x n matrix as padded columns of T; `transposed` swaps rows and columns, `scale` multiplies.
template <class T>
void store_columns(const std::vector<double>& matrix, std::size_t n, std::size_t stride, bool transposed, double scale, T* out) {
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) out[j * stride + i] = static_cast<T>(scale * (transposed ? matrix[j * n + i] : matrix[i * n + j]));
    for (std::size_t i = n; i < stride; ++i) out[j * stride + i] = T{0};
  }
}

Vec3 difference(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

std::size_t octant(const OctreeNode& node) {
  return static_cast<std::size_t>((node.cell[0] & 1) * 4 + (node.cell[1] & 1) * 2 + (node.cell[2] & 1));
}

// Mean distance of a patch's points from the centre of its cube, in half sides; and of the farthest, on which the opening is based.
constexpr double kMeanRadius = 0.8;
constexpr double kFarthestRadius = 1.3;

// Distant nodes need fewer terms for the same error: the order that brings q^(order + 1) to what plan.order reaches at the opening, q the
// ratio of mean radii to distance. Symmetric in target and source, so adjoints stay exact.
int order_of(const Offset& offset, const SumPlan& plan) {
  const double distance = std::hypot(offset.displacement[0], offset.displacement[1], offset.displacement[2]);
  const double half_sides = 1 + std::ldexp(1.0, std::abs(offset.level_difference));
  const double nearest = kMeanRadius / kFarthestRadius * plan.opening;
  const double q = std::min(kMeanRadius * half_sides / distance, nearest);
  const double terms = (plan.order + 1) * std::log(nearest) / std::log(q);
  return std::clamp(static_cast<int>(std::ceil(terms)) - 1, 1, plan.order);
}

// The forms need different orders for the same error: the gradient of the winding field comes from dipoles alone and is sharply
// near-sighted, Stokeslets multiply potentials by coordinates. Measured over the clouds of fast_sum_test. An operator and its adjoint share
// the order: kGreenAdjoint of one harmonic is also the adjoint of the W in kStokesWinding.
int order_for(cpu::NearForm form, int batch, int order) {
  constexpr int kLeast = 2;
  if (form == cpu::NearForm::kWindingGradient) return std::min(order, std::max(kLeast, order - 2));
  const bool green = form == cpu::NearForm::kGreen || form == cpu::NearForm::kGreenAdjoint;
  return green && batch > 1 ? std::min(order, std::max(kLeast, order - 1)) : order;
}

template <class T>
std::array<T, 3> moved(const Vec3& v) {
  return {static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2])};
}

}  // namespace

template <class T>
SumEngine<T>::SumEngine(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Widths& widths,
                        const SumPlan& plan, const std::atomic<bool>* cancel)
    : plan_(plan), local_widths_(!widths.uniform()), cancel_(cancel), sources_(std::make_shared<Sources>()) {
  set_order(plan.order);
  Sources& s = *sources_;
  s.points = points;
  s.widths = widths.values;
  s.tree = build_octree(points, morton, s.widths, plan_.leaf_points);
  const std::size_t stride = field_stride();
  s.geometry.resize(geometry_fields() * stride);
  parallel::for_blocks(s.tree.leaves.size(), kNodeBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const OctreeNode& leaf = s.tree.nodes[s.tree.leaves[i]];
      const Vec3 centre = leaf.centre();
      for (std::size_t p = leaf.begin; p < leaf.end; ++p) {
        for (std::size_t a = 0; a < 3; ++a) s.geometry[a * stride + p] = static_cast<T>(points[p][a] - centre[a]);
        if (local_widths_) s.geometry[3 * stride + p] = static_cast<T>(s.widths[p] * s.widths[p]);
      }
    }
  });
  for (std::size_t o = 0; o < 8 && !plan_.direct; ++o) {
    const Vec3 shift{o & 4 ? 0.5 : -0.5, o & 2 ? 0.5 : -0.5, o & 1 ? 0.5 : -0.5};
    const std::vector<double> matrix = multipole_translation(shift, plan_.order);
    s.child_to_parent[o].resize(coefficients_ * stride_);
    s.parent_to_child[o].resize(coefficients_ * stride_);
    store_columns(matrix, coefficients_, stride_, false, 1.0, s.child_to_parent[o].data());
    store_columns(matrix, coefficients_, stride_, true, 0.5, s.parent_to_child[o].data());
  }
  target_tree_ = std::shared_ptr<Octree>(sources_, &s.tree);
  prepare(points, s.widths);
}

template <class T>
SumEngine<T>::SumEngine(const SumEngine& other, const std::vector<Vec3>& targets, const std::vector<std::uint64_t>& morton,
                        const std::atomic<bool>* cancel)
    : plan_(other.plan_), local_widths_(other.local_widths_), cancel_(cancel), sources_(other.sources_) {
  set_order(plan_.order);
  target_tree_ = std::make_shared<Octree>(build_query_octree(targets, morton, sources_->tree));
  prepare(targets, {sources_->widths[0]});
}

template <class T>
void SumEngine<T>::set_order(int order) {
  order_ = order;
  coefficients_ = coefficient_count(order);
  stride_ = cpu::padded_count(coefficients_);
}

template <class T>
void SumEngine<T>::prepare(const std::vector<Vec3>& targets, const std::vector<double>& target_widths) {
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
  lists_ = build_interaction_lists(tree, sources_->tree, plan_.direct ? 0.0 : plan_.opening, plan_.reach);
  make_matrices();
}

template <class T>
void SumEngine<T>::make_matrices() {
  const std::size_t offsets = lists_.offsets.size();
  offset_order_.resize(offsets);
  matrix_begin_.assign(offsets + 1, 0);
  for (std::size_t i = 0; i < offsets; ++i) {
    offset_order_[i] = order_of(lists_.offsets[i], plan_);
    const std::size_t n = coefficient_count(offset_order_[i]);
    matrix_begin_[i + 1] = matrix_begin_[i] + n * cpu::padded_count(n);
  }
  if (matrix_begin_.back() * sizeof(T) > kKeptMatrixBytes) return;
  matrices_.resize(matrix_begin_.back());
  std::vector<MultipoleToLocal> make;
  for (int order = 0; order <= plan_.order; ++order) make.emplace_back(order);
  parallel::for_blocks(offsets, kNodeBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t n = coefficient_count(offset_order_[i]);
      store_columns(make[static_cast<std::size_t>(offset_order_[i])].matrix(lists_.offsets[i]), n, cpu::padded_count(n), false, 1.0,
                    matrices_.data() + matrix_begin_[i]);
    }
  });
}

template <class T>
void SumEngine<T>::begin_values(std::size_t values) {
  const bool fresh = fields_.empty();
  field_count_ = geometry_fields() + values;
  if (fields_.size() < field_count_ * field_stride()) fields_.resize(field_count_ * field_stride());
  if (fresh) std::copy(sources_->geometry.begin(), sources_->geometry.end(), fields_.begin());
}

template <class T>
AlignedVector<T>& SumEngine<T>::target_data(std::size_t channels) {
  target_data_.resize(targets_->x.size() * channels);
  return target_data_;
}

template <class T>
cpu::LeafTask<T> SumEngine<T>::leaf_task(cpu::NearForm form, int batch, double half_side) const {
  cpu::LeafTask<T> task{};
  task.form = form;
  task.batch = batch;
  task.order = order_;
  task.half_side = static_cast<T>(half_side);
  task.local_widths = local_widths_;
  task.uniform_width_squared = static_cast<T>(sources_->widths[0] * sources_->widths[0]);
  task.stride = stride_;
  return task;
}

template <class T>
void SumEngine<T>::upward(cpu::NearForm form, int batch) {
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
  const cpu::Moved moving = form == cpu::NearForm::kStokesWinding ? cpu::Moved::kStokes : cpu::Moved::kAll;
  const std::size_t full_stride = cpu::padded_count(coefficient_count(plan_.order));
  for (std::size_t level = tree.levels(); level-- > 0;) {
    const std::size_t first = tree.level_begin[level];
    parallel::for_blocks(tree.level_begin[level + 1] - first, kNodeBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = first + begin; i < first + end; ++i) {
        const OctreeNode& node = tree.nodes[i];
        if (node.leaf()) continue;
        std::fill_n(multipole(i), multipole_channels_ * stride_, T{0});
        for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
          const cpu::TranslationMatrix<T> matrix{sources_->child_to_parent[octant(tree.nodes[c])].data(), coefficients_, stride_,
                                                 full_stride};
          const Vec3 move = difference(tree.nodes[c].centre(), node.centre());
          const cpu::Translation<T> up{multipole(c), multipole(i), moved<T>(move)};
          cpu::translate(matrix, &up, 1, multipole_channels_, stride_, moving);
        }
      }
    });
  }
}

template <class T>
void SumEngine<T>::across(cpu::NearForm form) {
  const Octree& tree = *target_tree_;
  locals_.resize(tree.nodes.size() * local_channels_ * stride_);
  const bool stokes = form == cpu::NearForm::kStokesWinding;
  const bool kept = !matrices_.empty();
  parallel::for_each(
      lists_.chunk_begin.size() - 1,
      [&](std::size_t chunk) {
        const std::size_t first = chunk * kTargetChunk;
        const std::size_t last = std::min(first + kTargetChunk, tree.nodes.size());
        std::fill(local(first), local(last - 1) + local_channels_ * stride_, T{0});
        std::vector<cpu::Translation<T>> moves;
        const std::size_t full = coefficient_count(plan_.order);
        AlignedVector<T> made(kept ? 0 : full * cpu::padded_count(full));
        for (std::size_t i = lists_.chunk_begin[chunk]; i < lists_.chunk_begin[chunk + 1];) {
          const std::uint32_t offset = lists_.far[i].offset;
          const std::size_t n = coefficient_count(offset_order_[offset]);
          const std::size_t used = std::min(n, coefficients_);
          const cpu::TranslationMatrix<T> matrix{kept ? matrices_.data() + matrix_begin_[offset] : made.data(), used,
                                                 cpu::padded_count(used), cpu::padded_count(n)};
          if (!kept) {
            store_columns(MultipoleToLocal(offset_order_[offset]).matrix(lists_.offsets[offset]), n, matrix.stride, false, 1.0,
                          made.data());
          }
          const Offset& displaced = lists_.offsets[offset];
          std::size_t level = 0;  // of the target; a group's targets ascend, and nodes are numbered level by level
          std::array<T, 3> move = moved<T>(displaced.to_source(level));
          cpu::Moved moving = cpu::Moved::kAll;
          if (stokes) moving = displaced.positive() ? cpu::Moved::kStokesForward : cpu::Moved::kStokesTransposed;
          moves.clear();
          for (; i < lists_.chunk_begin[chunk + 1] && lists_.far[i].offset == offset; ++i) {
            const FarPair& pair = lists_.far[i];
            if (pair.target >= tree.level_begin[level + 1]) {
              while (pair.target >= tree.level_begin[level + 1]) ++level;
              move = moved<T>(displaced.to_source(level));
            }
            moves.push_back({multipole(pair.source), local(pair.target), move});
          }
          cpu::translate(matrix, moves.data(), moves.size(), multipole_channels_, stride_, moving);
        }
      },
      cancel_);
}

template <class T>
void SumEngine<T>::downward(cpu::NearForm form) {
  const Octree& tree = *target_tree_;
  const cpu::Moved moving = form == cpu::NearForm::kStokesWinding ? cpu::Moved::kStokes : cpu::Moved::kAll;
  const std::size_t full_stride = cpu::padded_count(coefficient_count(plan_.order));
  for (std::size_t level = 1; level < tree.levels(); ++level) {
    const std::size_t first = tree.level_begin[level];
    parallel::for_blocks(tree.level_begin[level + 1] - first, kNodeBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = first + begin; i < first + end; ++i) {
        const OctreeNode& node = tree.nodes[i];
        const cpu::TranslationMatrix<T> matrix{sources_->parent_to_child[octant(node)].data(), coefficients_, stride_, full_stride};
        const Vec3 move = difference(tree.nodes[node.parent].centre(), node.centre());
        const cpu::Translation<T> down{local(node.parent), local(i), moved<T>(move)};
        cpu::translate(matrix, &down, 1, local_channels_, stride_, moving);
      }
    });
  }
}

template <class T>
void SumEngine<T>::leaves(cpu::NearForm form, int batch, std::size_t out_channels) {
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
          for (std::size_t k = lists_.near_begin[i]; k < lists_.near_begin[i + 1]; ++k) {
            const OctreeNode& source = source_tree.nodes[source_tree.leaves[lists_.near[k]]];
            const Vec3 shift = difference(source.centre(), centre);
            runs.push_back({source.begin, source.count(), {static_cast<T>(shift[0]), static_cast<T>(shift[1]), static_cast<T>(shift[2])}});
          }
          const std::size_t first = targets_->first_block[i];
          const std::size_t lane = first * cpu::kLanes;
          cpu::NearTask<T> near{};
          near.form = form;
          near.batch = batch;
          near.fields = fields_.data();
          near.field_count = field_count_;
          near.stride = field_stride();
          near.runs = runs.data();
          near.run_count = runs.size();
          near.count = leaf.count();
          near.x = targets_->x.data() + lane;
          near.y = targets_->y.data() + lane;
          near.z = targets_->z.data() + lane;
          near.width_squared = local_widths_ ? targets_->width_squared.data() + lane : nullptr;
          near.u = target_data_.data() + lane * data_channels;
          near.uniform_width_squared = static_cast<T>(sources_->widths[0] * sources_->widths[0]);
          near.local_widths = local_widths_;
          near.reach = static_cast<T>(std::min(plan_.reach, kMollifierReach<T>));
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
const std::vector<double>& SumEngine<T>::run(cpu::NearForm form, int batch, std::size_t out_channels) {
  multipole_channels_ = multipole_channels(form, batch, local_widths_);
  local_channels_ = multipole_channels_ + (form == cpu::NearForm::kStokesWinding ? 1 : 0);
  set_order(order_for(form, batch, plan_.order));
  out_.resize(targets_->x.size() * out_channels);
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
