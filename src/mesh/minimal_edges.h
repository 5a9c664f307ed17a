// The minimal edges of an octree, each exactly once: the cell, face and edge procedures of Ju, Losasso, Schaefer, Warren, "Dual contouring
// of Hermite data", SIGGRAPH 2002.
#pragma once

#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/field_octree.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace g3r::mesh {

namespace edges {

// The k-th of the four quadrants around an edge along axis d, counter-clockwise seen from +d: bit 0 = upper along d+1, bit 1 = along d+2.
// MinimalEdge::leaf is in this order.
inline std::size_t quadrant(std::size_t k) { return k ^ (k >> 1U); }

enum class Kind : std::uint8_t { kCell, kFace, kEdge };

struct Task {
  Kind kind = Kind::kCell;
  std::uint8_t axis = 0;  // normal of the face, direction of the edge
  // Of a cell: one; of a face: lower, upper; of an edge: bit 0 of the quadrant = upper along axis+1, bit 1 = along axis+2.
  std::array<std::uint32_t, kQuadrants> node{};
};

// Marks the nodes above the leaves for which marked(leaf) is not 0.
template <class Marked>
std::vector<std::uint8_t> mark_nodes(const Octree& octree, const Marked& marked) {
  std::vector<std::uint8_t> out(octree.node_count(), 0);
  for (auto i = static_cast<std::uint32_t>(out.size()); i-- > 0;) {  // children come after their parents
    if (!octree.is_split(i)) {
      out[i] = marked(static_cast<std::size_t>(octree.next_of(i))) ? 1 : 0;
    } else {
      for (std::size_t c = 0; c < kOctants; ++c) out[i] |= out[octree.next_of(i) + c];
    }
  }
  return out;
}

// The minimal edges of which some leaf around them is marked.
class Traversal {
 public:
  Traversal(const Octree& octree, std::vector<std::uint8_t> marked) : octree_(octree), marked_(std::move(marked)) {}

  // One step: the tasks below `task`, or the edge it ends at.
  template <class OnTask, class OnEdge>
  void expand(const Task& task, const OnTask& on_task, const OnEdge& on_edge) const {
    const std::size_t nodes = std::size_t{1} << static_cast<unsigned>(task.kind);
    std::uint8_t some = 0;
    for (std::size_t k = 0; k < nodes; ++k) some |= marked_[task.node[k]];
    if (some == 0) return;
    switch (task.kind) {
      case Kind::kCell:
        return expand_cell(task, on_task);
      case Kind::kFace:
        return expand_face(task, on_task);
      case Kind::kEdge:
        return expand_edge(task, on_task, on_edge);
    }
  }

  template <class OnEdge>
  void run(const Task& task, const OnEdge& on_edge) const {
    expand(
        task, [&](const Task& next) { run(next, on_edge); }, on_edge);
  }

 private:
  bool internal(std::uint32_t n) const { return octree_.is_split(n); }
  std::uint32_t child(std::uint32_t n, std::uint32_t bits) const { return internal(n) ? octree_.next_of(n) + bits : n; }

  template <class OnTask>
  void expand_cell(const Task& task, const OnTask& on_task) const {
    const std::uint32_t n = task.node[0];
    if (!internal(n)) return;
    for (std::uint32_t c = 0; c < kOctants; ++c) on_task(Task{Kind::kCell, 0, {child(n, c)}});
    for (std::uint32_t d = 0; d < 3; ++d) {
      const std::uint32_t u = (d + 1) % 3, v = (d + 2) % 3;
      for (std::uint32_t q = 0; q < kQuadrants; ++q) {
        const std::uint32_t bits = ((q & 1U) << u) | ((q >> 1U) << v);
        on_task(Task{Kind::kFace, static_cast<std::uint8_t>(d), {child(n, bits), child(n, bits | (1U << d))}});
      }
      for (std::uint32_t k = 0; k < 2; ++k) {
        Task edge{Kind::kEdge, static_cast<std::uint8_t>(d), {}};
        for (std::uint32_t q = 0; q < kQuadrants; ++q) edge.node[q] = child(n, (k << d) | ((q & 1U) << u) | ((q >> 1U) << v));
        on_task(edge);
      }
    }
  }

  template <class OnTask>
  void expand_face(const Task& task, const OnTask& on_task) const {
    const std::array<std::uint32_t, 2> side{task.node[0], task.node[1]};
    if (!internal(side[0]) && !internal(side[1])) return;
    const std::uint32_t d = task.axis, u = (d + 1) % 3, v = (d + 2) % 3;
    for (std::uint32_t q = 0; q < kQuadrants; ++q) {
      const std::uint32_t bits = ((q & 1U) << u) | ((q >> 1U) << v);
      on_task(Task{Kind::kFace, task.axis, {child(side[0], bits | (1U << d)), child(side[1], bits)}});
    }
    for (const std::uint32_t along : {u, v}) {
      const std::uint32_t e1 = (along + 1) % 3, e2 = (along + 2) % 3;
      for (std::uint32_t k = 0; k < 2; ++k) {
        Task edge{Kind::kEdge, static_cast<std::uint8_t>(along), {}};
        for (std::uint32_t q = 0; q < kQuadrants; ++q) {
          const std::uint32_t b1 = q & 1U, b2 = q >> 1U;
          const bool upper = (e1 == d ? b1 : b2) == 1;    // which of the two sides of the face
          const std::uint32_t other = e1 == d ? b2 : b1;  // half within the face
          const std::uint32_t other_axis = e1 == d ? e2 : e1;
          const std::uint32_t bits = (k << along) | (other << other_axis) | (upper ? 0U : 1U << d);
          edge.node[q] = child(side[upper ? 1 : 0], bits);
        }
        on_task(edge);
      }
    }
  }

  template <class OnTask, class OnEdge>
  void expand_edge(const Task& task, const OnTask& on_task, const OnEdge& on_edge) const {
    const std::uint32_t d = task.axis, u = (d + 1) % 3, v = (d + 2) % 3;
    const auto bits_of = [&](std::uint32_t q) { return ((1U - (q & 1U)) << u) | ((1U - (q >> 1U)) << v); };
    if (internal(task.node[0]) || internal(task.node[1]) || internal(task.node[2]) || internal(task.node[3])) {
      for (std::uint32_t k = 0; k < 2; ++k) {
        Task half{Kind::kEdge, task.axis, {}};
        for (std::uint32_t q = 0; q < kQuadrants; ++q) half.node[q] = child(task.node[q], bits_of(q) | (k << d));
        on_task(half);
      }
      return;
    }
    std::uint32_t smallest = 0;
    for (std::uint32_t q = 1; q < kQuadrants; ++q) {
      if (octree_.level_of(task.node[q]) > octree_.level_of(task.node[smallest])) smallest = q;
    }
    const std::uint32_t leaf = octree_.next_of(task.node[smallest]);
    MinimalEdge edge;
    edge.low = octree_.corner(leaf, bits_of(smallest));
    edge.high = octree_.corner(leaf, bits_of(smallest) | (1U << d));
    edge.axis = task.axis;
    for (std::size_t k = 0; k < kQuadrants; ++k) edge.leaf[k] = octree_.next_of(task.node[quadrant(k)]);
    on_edge(edge);
  }

  const Octree& octree_;
  std::vector<std::uint8_t> marked_;
};

/// Hands the minimal edges with a marked leaf around them to keep(edge, out), which may append to `out`, and returns all that it did.
template <class Out, class Keep>
std::vector<Out> find_edges(const Octree& octree, std::vector<std::uint8_t> marked, const Keep& keep, const std::atomic<bool>* cancel) {
  const Traversal traversal(octree, std::move(marked));
  std::vector<Out> edges;
  std::vector<Task> tasks{Task{}};
  while (!tasks.empty() && tasks.size() < kTasks) {
    std::vector<Task> next;
    for (const Task& task : tasks) {
      traversal.expand(
          task, [&](const Task& t) { next.push_back(t); }, [&](const MinimalEdge& e) { keep(e, edges); });
    }
    tasks = std::move(next);
  }
  std::vector<std::vector<Out>> found(tasks.size());
  parallel::for_each(
      tasks.size(), [&](std::size_t t) { traversal.run(tasks[t], [&](const MinimalEdge& e) { keep(e, found[t]); }); }, cancel);
  std::size_t count = edges.size();
  for (const auto& part : found) count += part.size();
  edges.reserve(count);
  for (auto& part : found) {
    edges.insert(edges.end(), part.begin(), part.end());
    std::vector<Out>().swap(part);  // not all twice in memory
  }
  return edges;
}

}  // namespace edges

}  // namespace g3r::mesh
