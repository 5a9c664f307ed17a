#include "sum/sum_passes.h"

#include "cpu/far_field.h"
#include "cpu/parallel.h"
#include "cpu/translations.h"
#include "expansions/expansions.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace g3r {
namespace {

constexpr std::size_t kLeafBlock = 4;   // leaves per parallel block
constexpr std::size_t kNodeBlock = 32;  // nodes per parallel block

std::size_t blocks_of(const OctreeNode& leaf) { return (leaf.count() + cpu::kLanes - 1) / cpu::kLanes; }

// The vector from one centre to another, exact in T.
template <class T>
std::array<T, 3> moved(const Vec3& v) {
  return {static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2])};
}
template <class T>
std::array<T, 3> move_between(const Vec3& to, const Vec3& from) {
  return moved<T>({to[0] - from[0], to[1] - from[1], to[2] - from[2]});
}

std::size_t octant(const OctreeNode& node) {
  return static_cast<std::size_t>((node.cell[0] & 1) * 4 + (node.cell[1] & 1) * 2 + (node.cell[2] & 1));
}

}  // namespace

// One run of the passes.
template <class T>
class SumPasses<T>::Run {
 public:
  Run(SumGeometry<T>& geometry, const cpu::SumRequest<T>& request, const M2lTerms& terms, const TakeSums& take)
      : geometry_(geometry),
        request_(request),
        take_(take),
        source_tree_(geometry.sources().tree),
        target_tree_(geometry.target_tree()),
        lists_(geometry.lists()),
        matrices_(request.direct ? nullptr : &geometry.matrices(terms)),
        coefficients_(coefficient_count(request.order)),
        stride_(cpu::padded_count(coefficients_)) {}

  void near_only();
  void upward(UnsetVector<T>& multipoles);
  void to_targets(UnsetVector<T>& multipoles);

 private:
  // Moves between a node and its parent, by the node's octant.
  using MovesByOctant = std::array<std::vector<cpu::Translation<T>>, 8>;
  // Far pairs that share a matrix, by how their expansions move.
  struct Moves {
    std::vector<cpu::Translation<T>> all, forward, transposed;
  };
  // What the loop over the leaves of a block reuses: the targets of a leaf in blocks of cpu::kLanes, the last of which repeats the last
  // point, their near sources, and their sums.
  struct LeafSpace {
    AlignedVector<T> x, y, z, width_squared, data;
    std::vector<cpu::SourceRun<T>> runs;
    std::vector<double> out;
    AlignedVector<T> workspace;
  };

  [[nodiscard]] bool is_stokes() const { return request_.form == cpu::NearForm::kStokesWinding; }
  [[nodiscard]] T squared_width() const { return static_cast<T>(geometry_.uniform_width() * geometry_.uniform_width()); }
  // Elements of the local expansions of a node.
  [[nodiscard]] std::size_t local_size() const { return request_.local_channels * stride_; }
  T* multipole(std::size_t node) { return multipoles_ + node * request_.multipole_channels * stride_; }

  [[nodiscard]] cpu::LeafTask<T> leaf_task(double half_side) const;
  void translate_levels(const std::array<StoredTranslation<T>, 8>& matrices, const MovesByOctant& moves, std::size_t channels) const;
  std::size_t gather(std::size_t begin, std::size_t end, const FarPair*& pair, T* locals, Moves& moves);
  void across(std::size_t part, T* locals);
  template <class At>
  void downward(const std::uint32_t* begin, const std::uint32_t* end, const At& at);
  AlignedVector<T> locals_above();
  void subtree(std::size_t part, AlignedVector<T>& above);
  [[nodiscard]] LeafSpace leaf_space() const;
  void place(const OctreeNode& leaf, LeafSpace& space) const;
  void leaf(std::size_t number, const T* local, LeafSpace& space);

  SumGeometry<T>& geometry_;
  const cpu::SumRequest<T>& request_;
  const TakeSums& take_;
  const Octree& source_tree_;
  const Octree& target_tree_;
  const InteractionLists& lists_;
  const M2lMatrices<T>* matrices_;
  std::size_t coefficients_;
  std::size_t stride_;  // of one expansion
  T* multipoles_ = nullptr;
};

template <class T>
cpu::LeafTask<T> SumPasses<T>::Run::leaf_task(double half_side) const {
  cpu::LeafTask<T> task{};
  task.form = request_.form;
  task.batch = request_.batch;
  task.order = request_.order;
  task.half_side = static_cast<T>(half_side);
  task.local_widths = geometry_.local_widths();
  task.uniform_width_squared = squared_width();
  task.stride = stride_;
  return task;
}

// P2M at the leaves, M2M level by level.
template <class T>
void SumPasses<T>::Run::upward(UnsetVector<T>& multipoles) {
  const std::size_t channels = request_.multipole_channels;
  if (multipoles.size() < source_tree_.nodes.size() * channels * stride_) {
    multipoles = UnsetVector<T>();  // not twice in memory
    multipoles.resize(source_tree_.nodes.size() * channels * stride_);
  }
  multipoles_ = multipoles.data();
  parallel::for_blocks(
      source_tree_.leaves.size(), kLeafBlock,
      [&](std::size_t begin, std::size_t end) {
        AlignedVector<T> workspace(cpu::leaf_workspace(coefficients_, channels));
        for (std::size_t i = begin; i < end; ++i) {
          const OctreeNode& leaf = source_tree_.nodes[source_tree_.leaves[i]];
          cpu::LeafTask<T> task = leaf_task(leaf.half_side());
          task.places = geometry_.sources().places.data() + leaf.begin;
          task.source_width_squared = geometry_.local_widths() ? geometry_.squared_widths() + leaf.begin : nullptr;
          task.values = request_.values + leaf.begin;
          task.value_count = request_.value_fields;
          task.field_stride = geometry_.source_stride();
          task.count = leaf.count();
          task.channels = channels;
          task.multipole = multipole(source_tree_.leaves[i]);
          task.workspace = workspace.data();
          cpu::points_to_multipole(task);
        }
      },
      request_.cancel);
  const T* unchanged = matrices_->signs(Offset());
  for (std::size_t level = source_tree_.levels(); level-- > 0;) {
    const std::size_t first = source_tree_.level_begin[level];
    parallel::for_blocks(source_tree_.level_begin[level + 1] - first, kNodeBlock, [&](std::size_t begin, std::size_t end) {
      MovesByOctant up;
      for (std::size_t i = first + begin; i < first + end; ++i) {
        const OctreeNode& node = source_tree_.nodes[i];
        if (node.leaf()) continue;
        std::fill_n(multipole(i), channels * stride_, T{0});
        for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
          const OctreeNode& child = source_tree_.nodes[c];
          up[octant(child)].push_back({multipole(c), multipole(i), unchanged, move_between<T>(child.centre(), node.centre())});
        }
      }
      translate_levels(geometry_.sources().child_to_parent, up, channels);
    });
  }
}

// Children ascend by octant, so each parent is added to in the order of its children.
template <class T>
void SumPasses<T>::Run::translate_levels(const std::array<StoredTranslation<T>, 8>& matrices, const MovesByOctant& moves,
                                         std::size_t channels) const {
  const cpu::Moved moving = is_stokes() ? cpu::Moved::kStokes : cpu::Moved::kAll;
  for (std::size_t o = 0; o < moves.size(); ++o) {
    if (!moves[o].empty()) {
      cpu::translate(matrices[o].first(coefficients_), moves[o].data(), moves[o].size(), channels, stride_, moving);
    }
  }
}

// The runs of far pairs from `begin` on that share its matrix. Returns the end of them, and `pair` is that of their pairs.
template <class T>
std::size_t SumPasses<T>::Run::gather(std::size_t begin, std::size_t end, const FarPair*& pair, T* locals, Moves& moves) {
  moves.all.clear();
  moves.forward.clear();
  moves.transposed.clear();
  const std::vector<std::uint32_t>& level_begin = target_tree_.level_begin;
  const std::size_t index = matrices_->index(lists_.runs[begin].offset);
  std::size_t run = begin;
  for (; run < end && matrices_->index(lists_.runs[run].offset) == index; ++run) {
    const Offset& offset = lists_.offsets[lists_.runs[run].offset];
    const T* signs = matrices_->signs(offset);
    std::vector<cpu::Translation<T>>& to = !is_stokes() ? moves.all : (offset.positive() ? moves.forward : moves.transposed);
    std::size_t level = 0;  // of the target; an offset's targets ascend, and nodes are numbered level by level
    std::array<T, 3> move = moved<T>(offset.to_source(level));
    for (const FarPair* run_end = pair + lists_.runs[run].pairs; pair != run_end; ++pair) {
      if (pair->target >= level_begin[level + 1]) {
        while (pair->target >= level_begin[level + 1]) ++level;
        move = moved<T>(offset.to_source(level));
      }
      to.push_back({multipole(pair->source), locals + lists_.parts.slot[pair->target] * local_size(), signs, move});
    }
  }
  return run;
}

// M2L of the far pairs of a part, to local expansions by the slots of its nodes.
template <class T>
void SumPasses<T>::Run::across(std::size_t part, T* locals) {
  AlignedVector<T> made;
  Moves moves;
  const FarPair* pair = lists_.far.data() + lists_.far_begin[part];
  for (std::size_t run = lists_.run_begin[part]; run < lists_.run_begin[part + 1];) {
    const std::size_t index = matrices_->index(lists_.runs[run].offset);
    run = gather(run, lists_.run_begin[part + 1], pair, locals, moves);
    const cpu::TranslationMatrix<T> matrix = matrices_->matrix(index, made);
    for (const auto& [moving, some] : {std::pair{cpu::Moved::kAll, &moves.all}, std::pair{cpu::Moved::kStokesForward, &moves.forward},
                                       std::pair{cpu::Moved::kStokesTransposed, &moves.transposed}}) {
      if (!some->empty()) cpu::translate(matrix, some->data(), some->size(), request_.multipole_channels, stride_, moving);
    }
  }
}

// L2L from parents to some children. `at(node)`: where the local expansions of a node are.
template <class T>
template <class At>
void SumPasses<T>::Run::downward(const std::uint32_t* begin, const std::uint32_t* end, const At& at) {
  const T* unchanged = matrices_->signs(Offset());
  MovesByOctant down;
  for (const std::uint32_t* i = begin; i != end; ++i) {
    const OctreeNode& node = target_tree_.nodes[*i];
    const Vec3 parent = target_tree_.nodes[node.parent].centre();
    down[octant(node)].push_back({at(node.parent), at(*i), unchanged, move_between<T>(parent, node.centre())});
  }
  translate_levels(geometry_.sources().parent_to_child, down, request_.local_channels);
}

// Local expansions of the nodes above all subtrees, by their slots.
template <class T>
AlignedVector<T> SumPasses<T>::Run::locals_above() {
  const TreeParts& parts = lists_.parts;
  AlignedVector<T> locals(parts.above.size() * local_size());
  parallel::for_each(
      parts.size() - parts.roots.size(), [&](std::size_t k) { across(parts.roots.size() + k, locals.data()); }, request_.cancel);
  const std::vector<OctreeNode>& nodes = target_tree_.nodes;
  for (auto begin = parts.above.begin(); begin != parts.above.end();) {
    const auto end = std::find_if(begin, parts.above.end(), [&](std::uint32_t i) { return nodes[i].level > nodes[*begin].level; });
    if (*begin != 0) {
      downward(&*begin, &*begin + (end - begin), [&](std::uint32_t i) { return locals.data() + parts.slot[i] * local_size(); });
    }
    begin = end;
  }
  return locals;
}

// The local expansions of a subtree, and the sums at its leaves.
template <class T>
void SumPasses<T>::Run::subtree(std::size_t part, AlignedVector<T>& above) {
  const Octree& tree = target_tree_;
  const TreeParts& parts = lists_.parts;
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
  AlignedVector<T> locals(members.size() * local_size());
  across(part, locals.data());
  const OctreeNode& root = tree.nodes[parts.roots[part]];
  const auto at = [&](std::uint32_t i) { return (parts.part_of[i] == part ? locals : above).data() + parts.slot[i] * local_size(); };
  for (std::size_t level = root.level > 0 ? 0 : 1; level + 1 < level_begin.size(); ++level) {
    downward(members.data() + level_begin[level], members.data() + level_begin[level + 1], at);
  }
  const auto leaf_from = [&](std::uint32_t point) {
    const auto before = [&](std::uint32_t leaf, std::uint32_t p) { return tree.nodes[leaf].begin < p; };
    return static_cast<std::size_t>(std::lower_bound(tree.leaves.begin(), tree.leaves.end(), point, before) - tree.leaves.begin());
  };
  const std::size_t first = leaf_from(root.begin);
  parallel::for_blocks(leaf_from(root.end) - first, kLeafBlock, [&](std::size_t begin, std::size_t end) {  // small clouds are one part
    LeafSpace space = leaf_space();
    for (std::size_t i = first + begin; i < first + end; ++i) leaf(i, at(tree.leaves[i]), space);
  });
}

template <class T>
auto SumPasses<T>::Run::leaf_space() const -> LeafSpace {
  LeafSpace space;
  space.workspace.resize(std::max(cpu::near_workspace((geometry_.local_widths() ? 4 : 3) + request_.value_fields),
                                  request_.direct ? 0 : cpu::leaf_workspace(coefficients_, 1)));
  return space;
}

// The targets of a leaf in blocks.
template <class T>
void SumPasses<T>::Run::place(const OctreeNode& leaf, LeafSpace& space) const {
  const std::size_t lanes = blocks_of(leaf) * cpu::kLanes;
  const std::size_t fields = request_.data_fields;
  for (AlignedVector<T>* field : {&space.x, &space.y, &space.z}) field->resize(lanes);
  if (geometry_.local_widths()) space.width_squared.resize(lanes);
  space.data.resize(lanes * fields);
  const T* places = geometry_.target_places().data();
  const std::size_t stride = geometry_.target_stride();
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const std::size_t p = std::min<std::size_t>(leaf.begin + lane, leaf.end - 1);
    space.x[lane] = places[p];
    space.y[lane] = places[stride + p];
    space.z[lane] = places[2 * stride + p];
    if (geometry_.local_widths()) space.width_squared[lane] = geometry_.target_squared_widths()[p];
    for (std::size_t k = 0; k < fields; ++k) {
      space.data[(lane / cpu::kLanes * fields + k) * cpu::kLanes + lane % cpu::kLanes] = request_.target_data[k * stride + p];
    }
  }
}

// The sums at the targets of a leaf: near field, and L2P from `local`.
template <class T>
void SumPasses<T>::Run::leaf(std::size_t number, const T* local, LeafSpace& space) {
  const OctreeNode& leaf = target_tree_.nodes[target_tree_.leaves[number]];
  const Vec3 centre = leaf.centre();
  space.runs.clear();
  for (std::size_t k = lists_.near_begin[number]; k < lists_.near_begin[number + 1]; ++k) {
    const OctreeNode& source = source_tree_.nodes[source_tree_.leaves[lists_.near[k]]];
    const std::array<T, 3> shift = move_between<T>(source.centre(), centre);
    space.runs.push_back({source.begin, source.count(), {shift[0], shift[1], shift[2]}});
  }
  place(leaf, space);
  space.out.resize(blocks_of(leaf) * cpu::kLanes * request_.out_channels);
  cpu::NearTask<T> near{};
  near.form = request_.form;
  near.batch = request_.batch;
  near.places = geometry_.sources().places.data();
  near.source_width_squared = geometry_.squared_widths();
  near.values = request_.values;
  near.stride = geometry_.source_stride();
  near.runs = space.runs.data();
  near.run_count = space.runs.size();
  near.count = leaf.count();
  near.x = space.x.data();
  near.y = space.y.data();
  near.z = space.z.data();
  near.width_squared = geometry_.local_widths() ? space.width_squared.data() : nullptr;
  near.u = space.data.data();
  near.uniform_width_squared = squared_width();
  near.local_widths = geometry_.local_widths();
  near.reach = request_.reach;
  near.kernel_error = request_.kernel_error;
  near.out = space.out.data();
  near.workspace = space.workspace.data();
  cpu::near_field(near);
  if (!request_.direct) {
    cpu::LeafTask<T> far = leaf_task(leaf.half_side());
    far.local = local;
    far.x = near.x;
    far.y = near.y;
    far.z = near.z;
    far.width_squared = near.width_squared;
    far.u = near.u;
    far.block_count = blocks_of(leaf);
    far.out = near.out;
    far.workspace = near.workspace;
    cpu::local_to_points(far);
  }
  take_(leaf.begin, leaf.count(), space.out.data());
}

template <class T>
void SumPasses<T>::Run::near_only() {
  parallel::for_blocks(
      target_tree_.leaves.size(), kLeafBlock,
      [&](std::size_t begin, std::size_t end) {
        LeafSpace space = leaf_space();
        for (std::size_t i = begin; i < end; ++i) leaf(i, nullptr, space);
      },
      request_.cancel);
}

template <class T>
void SumPasses<T>::Run::to_targets(UnsetVector<T>& multipoles) {
  multipoles_ = multipoles.data();
  AlignedVector<T> above = locals_above();
  parallel::for_each(
      lists_.parts.roots.size(), [&](std::size_t part) { subtree(part, above); }, request_.cancel);
}

template <class T>
void SumPasses<T>::run(SumGeometry<T>& geometry, const cpu::SumRequest<T>& request, const M2lTerms& terms, const TakeSums& take) {
  Run run(geometry, request, terms, take);
  if (request.direct) return run.near_only();
  if (multipoles_of_ != request.form) run.upward(multipoles_);
  multipoles_of_ = request.form;
  run.to_targets(multipoles_);
}

template class SumPasses<float>;
template class SumPasses<double>;

}  // namespace g3r
