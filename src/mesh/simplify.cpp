#include "mesh/simplify.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/edge_collapse.h"
#include "mesh/mesh_parts.h"
#include "mesh/quadric.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace g3r::mesh {
namespace {

using vector::dot;
using vector::subtract;

// The share of the cost of slivers that counts: what the rounding of coordinates in files costs, so that all else comes before it.
constexpr double kFree = std::numeric_limits<float>::epsilon();

class Simplification {
 public:
  explicit Simplification(Mesh& mesh)
      : mesh_(mesh),
        edges_(mesh),
        origin_(mesh.vertices[mesh.triangles.front()[0]]),
        quadric_(mesh.vertices.size()),
        changes_(mesh.vertices.size(), 0) {
    for (const auto& t : mesh.triangles) add_planes(t);
  }

  // Edges that were refused may be collapsed once those around them are: so all are tried again while some are.
  const std::vector<std::uint8_t>& run(std::size_t faces, const std::atomic<bool>* cancel) {
    for (std::size_t before = 0; edges_.count() > faces && edges_.count() != before;) {
      before = edges_.count();
      push_all();
      for (std::size_t count = 0; !queue_.empty() && edges_.count() > faces; ++count) {
        if (count % parallel::kSmallBlock == 0 && cancel != nullptr && cancel->load()) throw Cancelled();
        const Entry next = queue_.top();
        queue_.pop();
        if (is_current(next)) collapse_or_delay(next);
      }
      queue_ = {};
    }
    return edges_.is_left();
  }

 private:
  using Entry = std::tuple<double, std::uint32_t, std::uint32_t, std::uint64_t>;  // cost, from, to, changes of both

  // That of a triangle, and across its edges that are boundaries one that stands on it, so that boundaries keep their place.
  void add_planes(const std::array<std::uint32_t, 3>& t) {
    const Vec3 n = edges_.normal_of(t);
    const double area = std::sqrt(dot(n, n));
    if (!(area > 0)) return;
    const Vec3 unit = vector::scale(n, 1 / area);
    add_plane(t, unit, t[0], area);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (!edges_.is_boundary(a, b)) continue;
      const Vec3 along = subtract(edges_.place(b), edges_.place(a));
      add_plane({a, b, b}, vector::normalised(vector::cross(along, unit)), a, dot(along, along));
    }
  }
  void add_plane(const std::array<std::uint32_t, 3>& vertices, const Vec3& unit, std::uint32_t on, double weight) {
    const double distance = -dot(unit, subtract(edges_.place(on), origin_));
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == 0 || vertices[k] != vertices[k - 1]) quadric_[vertices[k]].add_plane(unit, distance, weight);
    }
  }

  [[nodiscard]] double cost(std::uint32_t from, std::uint32_t to) const {
    Quadric both = quadric_[from];
    both.add(quadric_[to]);
    return both.squared_distances(subtract(edges_.place(to), origin_));
  }
  void push(std::uint32_t a, std::uint32_t b) {
    const double onto_b = cost(a, b), onto_a = cost(b, a);
    const bool forward = std::tie(onto_b, a) <= std::tie(onto_a, b);
    queue_.emplace(forward ? onto_b : onto_a, forward ? a : b, forward ? b : a, std::uint64_t{changes_[a]} + changes_[b]);
  }
  void push_all() {
    for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
      if (edges_.is_left()[f] == 0) continue;
      const auto& t = mesh_.triangles[f];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        if (a < b || edges_.is_boundary(a, b)) push(a, b);
      }
    }
  }
  // Of the slivers that the collapse makes, or makes lower. So little of it counts that it decides where the surface stays: within facets,
  // where all collapses are free, those without slivers come first.
  [[nodiscard]] double cost_of_slivers(std::uint32_t from, std::uint32_t to) const {
    double sum = 0;
    edges_.for_triangles_of(from, [&](const std::array<std::uint32_t, 3>& t) {
      if (std::find(t.begin(), t.end(), to) == t.end()) sum += std::max(0.0, sliver(t, from, to) - sliver(t, kNone, kNone));
      return true;
    });
    return kFree * sum;
  }
  // The cost of moving a corner of a triangle lower than kAtOnePlace of its longest side to where it is as high; 0 of others. With the
  // vertex `from` moved to `to`.
  [[nodiscard]] double sliver(const std::array<std::uint32_t, 3>& t, std::uint32_t from, std::uint32_t to) const {
    const double squared = longest_squared(t, from, to);
    const Vec3 n = edges_.normal_of(t, from, to);
    const double longest = std::sqrt(squared);
    const double lacks = kAtOnePlace * longest - std::sqrt(dot(n, n)) / longest;
    return lacks > 0 ? lacks * lacks * kAtOnePlace * squared : 0;
  }
  [[nodiscard]] double longest_squared(const std::array<std::uint32_t, 3>& t, std::uint32_t from, std::uint32_t to) const {
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      squared = std::max(squared, edges_.squared_length(a == from ? to : a, b == from ? to : b));
    }
    return squared;
  }
  [[nodiscard]] bool is_current(const Entry& entry) const {
    const auto& [unused, from, to, changes] = entry;
    return edges_.is_used(from) && edges_.is_used(to) && changes == std::uint64_t{changes_[from]} + changes_[to];
  }
  // Nor leaves one whose direction is rounding.
  [[nodiscard]] bool turns_none_over(std::uint32_t from, std::uint32_t to) const {
    return edges_.for_triangles_of(from, [&](const std::array<std::uint32_t, 3>& t) {
      if (std::find(t.begin(), t.end(), to) != t.end()) return true;
      const Vec3 after = edges_.normal_of(t, from, to);
      return dot(edges_.normal_of(t), after) > 0 && std::sqrt(dot(after, after)) > kRounding * longest_squared(t, from, to);
    });
  }
  // Slivers are looked for when the turn of an edge comes: what they cost may delay it.
  void collapse_or_delay(const Entry& next) {
    const auto& [before, from, to, changes] = next;
    const double whole = cost(from, to) + cost_of_slivers(from, to);
    if (whole > before) {
      queue_.emplace(whole, from, to, changes);
    } else {
      collapse(from, to);
    }
  }
  void collapse(std::uint32_t from, std::uint32_t to) {
    if (!turns_none_over(from, to) || !edges_.collapse(from, to)) return;
    quadric_[to].add(quadric_[from]);
    ++changes_[to];
    edges_.find_neighbours(to, neighbours_);
    for (const std::uint32_t v : neighbours_) push(to, v);
  }

  Mesh& mesh_;
  EdgeCollapse edges_;
  Vec3 origin_;  // of the quadrics: far from 0 they would cancel
  std::vector<Quadric> quadric_;
  std::vector<std::uint32_t> changes_;  // of the quadric of each vertex
  std::vector<std::uint32_t> neighbours_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

void simplify(Mesh& mesh, std::size_t faces, const std::atomic<bool>* cancel) {
  if (mesh.triangles.size() <= faces) return;
  Simplification simplification(mesh);
  remove_triangles(mesh, simplification.run(faces, cancel));
}

}  // namespace g3r::mesh
