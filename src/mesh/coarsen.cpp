#include "mesh/coarsen.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/distance_to_points.h"
#include "mesh/mesh_parts.h"
#include "mesh/quadric.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <queue>
#include <tuple>
#include <utility>

namespace g3r::mesh {
namespace {

using vector::dot;
using vector::subtract;

// The distance from the old surface over the length: fits miss more, and with 0.01 AE_m grows by 0.2 %.
constexpr double kTolerance = 0.003;
// The cosine of the most that triangles around a vertex differ by from their mean, 4.4 degrees, before and after, so that a flat part loses
// no more of its area: surface that bends more has its vertices for that.
constexpr double kTurn = 1 - kTolerance;

// A mesh whose edges are collapsed.
class Collapsing {
 public:
  Collapsing(Mesh& mesh, std::vector<double> length)
      : mesh_(mesh),
        origin_(mesh.vertices[mesh.triangles.front()[0]]),
        length_(std::move(length)),
        alive_(mesh.triangles.size(), 1),
        first_(mesh.vertices.size(), kNone),
        next_(3 * mesh.triangles.size(), kNone),
        quadric_(mesh.vertices.size()) {
    for (std::size_t corner = next_.size(); corner-- > 0;) {
      std::uint32_t& first = first_[mesh.triangles[corner / 3][corner % 3]];
      next_[corner] = first;
      first = static_cast<std::uint32_t>(corner);
    }
    for (const auto& t : mesh.triangles) {
      if (std::none_of(t.begin(), t.end(), [&](std::uint32_t v) { return length_[v] > 0; })) continue;
      const Vec3 n = normal_of(t, kNone, kNone);
      const double area = std::sqrt(dot(n, n));
      if (!(area > 0)) continue;
      const Vec3 unit = vector::scale(n, 1 / area);
      for (const std::uint32_t v : t) quadric_[v].add_plane(unit, -dot(unit, subtract(mesh.vertices[t[0]], origin_)), area);
    }
  }

  // Returns which triangles are left.
  std::vector<std::uint8_t> run(const std::atomic<bool>* cancel) {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3];
        if (a < b) push(a, b);
      }
    }
    for (std::size_t count = 0; !queue_.empty(); ++count) {
      if (count % parallel::kSmallBlock == 0 && cancel != nullptr && cancel->load()) throw Cancelled();
      const auto [squared, a, b] = queue_.top();
      queue_.pop();
      if (first_[a] == kNone || first_[b] == kNone || squared != squared_length(a, b)) continue;
      const bool forward = cost(a, b) <= cost(b, a);
      if (!collapse(forward ? a : b, forward ? b : a)) collapse(forward ? b : a, forward ? a : b);
    }
    return std::move(alive_);
  }

 private:
  using Entry = std::tuple<double, std::uint32_t, std::uint32_t>;  // squared length, low, high

  [[nodiscard]] double squared_length(std::uint32_t a, std::uint32_t b) const {
    const Vec3 d = subtract(mesh_.vertices[a], mesh_.vertices[b]);
    return dot(d, d);
  }
  void push(std::uint32_t a, std::uint32_t b) {
    const double squared = squared_length(a, b), limit = std::min(length_[a], length_[b]);
    if (squared < limit * limit) queue_.emplace(squared, std::min(a, b), std::max(a, b));
  }
  // Of a triangle, with `from` moved to `to`.
  [[nodiscard]] Vec3 normal_of(const std::array<std::uint32_t, 3>& t, std::uint32_t from, std::uint32_t to) const {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh_.vertices[t[k] == from ? to : t[k]];
    return vector::cross(subtract(p[1], p[0]), subtract(p[2], p[0]));
  }
  // The mean square of the distances from the planes that both ends stand for.
  [[nodiscard]] double cost(std::uint32_t from, std::uint32_t to) const {
    Quadric both = quadric_[from];
    both.add(quadric_[to]);
    return both.weight > 0 ? both.squared_distances(subtract(mesh_.vertices[to], origin_)) / both.weight
                           : std::numeric_limits<double>::infinity();
  }

  void ring_of(std::uint32_t v, std::vector<std::uint32_t>& out) const {
    out.clear();
    for (std::uint32_t corner = first_[v]; corner != kNone; corner = next_[corner]) {
      const std::uint32_t t = corner / 3, k = corner % 3;
      if (alive_[t] == 0) continue;
      out.push_back(mesh_.triangles[t][(k + 1) % 3]);
    }
    std::sort(out.begin(), out.end());
  }

  // Dey, Edelsbrunner, Guha, Nekhayev, "Topology preserving edge contraction", 1999: the ends have exactly two neighbours in common.
  [[nodiscard]] bool keeps_topology(std::uint32_t from, std::uint32_t to) {
    ring_of(from, ring_);
    ring_of(to, other_);
    if (ring_.size() <= 3 && other_.size() <= 3) return false;  // a tetrahedron
    common_.clear();
    std::set_intersection(ring_.begin(), ring_.end(), other_.begin(), other_.end(), std::back_inserter(common_));
    return common_.size() == 2;
  }

  [[nodiscard]] bool keeps_shape(std::uint32_t from, std::uint32_t to) const {
    const double limit = std::min(length_[from], length_[to]), longest = 2 * limit;  // as in a leaf's diagonals
    if (cost(from, to) > kTolerance * kTolerance * limit * limit) return false;
    Vec3 mean{0, 0, 0};
    for (std::uint32_t corner = first_[from]; corner != kNone; corner = next_[corner]) {
      if (alive_[corner / 3] != 0) mean = vector::add(mean, normal_of(mesh_.triangles[corner / 3], kNone, kNone));
    }
    mean = vector::normalised(mean);
    for (std::uint32_t corner = first_[from]; corner != kNone; corner = next_[corner]) {
      const std::uint32_t f = corner / 3;
      const auto& t = mesh_.triangles[f];
      if (alive_[f] == 0) continue;
      if (!(dot(mean, vector::normalised(normal_of(t, kNone, kNone))) >= kTurn)) return false;
      if (std::find(t.begin(), t.end(), to) != t.end()) continue;
      if (!(dot(mean, vector::normalised(normal_of(t, from, to))) >= kTurn)) return false;
      for (const std::uint32_t v : t) {
        if (v != from && squared_length(v, to) > longest * longest) return false;
      }
    }
    return true;
  }

  bool collapse(std::uint32_t from, std::uint32_t to) {
    if (!keeps_shape(from, to) || !keeps_topology(from, to)) return false;
    std::uint32_t last = first_[to];
    while (next_[last] != kNone) last = next_[last];
    next_[last] = first_[from];
    for (std::uint32_t corner = first_[from]; corner != kNone; corner = next_[corner]) {
      auto& t = mesh_.triangles[corner / 3];
      if (std::find(t.begin(), t.end(), to) != t.end()) alive_[corner / 3] = 0;
      t[corner % 3] = to;
    }
    first_[from] = kNone;
    quadric_[to].add(quadric_[from]);
    for (const std::uint32_t v : ring_) {
      if (v != to) push(to, v);
    }
    return true;
  }

  Mesh& mesh_;
  Vec3 origin_;  // of the quadrics: far from 0 they would cancel
  std::vector<double> length_;
  std::vector<std::uint8_t> alive_;          // triangles
  std::vector<std::uint32_t> first_, next_;  // corners of each vertex, one after another
  std::vector<Quadric> quadric_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::vector<std::uint32_t> ring_, other_, common_;
};

}  // namespace

std::vector<double> lengths_to_carry(const Prepared& prepared, const std::vector<double>& size) {
  const std::vector<Vec3>& positions = prepared.points.positions;
  const std::vector<Vec3>& normals = prepared.points.normals;
  const std::vector<double>& spacing = prepared.points.spacing;
  const std::size_t n = positions.size(), stride = prepared.near.size() / n;
  std::vector<double> lengths(n, 0);
  parallel::for_blocks(n, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (size[i] >= spacing[i]) continue;
      std::size_t count = 0;
      double farthest = 0;
      for (std::size_t k = 1; k < stride && count < kRing; ++k) {
        const std::uint32_t j = prepared.near[i * stride + k];
        const Vec3 d = subtract(positions[j], positions[i]);
        const double squared = dot(d, d), along = dot(d, normals[i]);
        if (dot(normals[i], normals[j]) < kAlong || along * along > kSlant * kSlant * squared) continue;
        farthest = squared;
        ++count;
      }
      // As for the spacing, the area of a disc for each: s = d_m sqrt(pi / m).
      if (count >= kPatchPoints)
        lengths[i] = kFinestCell / std::numbers::sqrt2 * std::sqrt(farthest * std::numbers::pi / static_cast<double>(count));
    }
  });
  return lengths;
}

void coarsen(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& lengths, const std::atomic<bool>* cancel) {
  if (mesh.triangles.empty() || std::all_of(lengths.begin(), lengths.end(), [](double l) { return l == 0; })) return;
  std::vector<double> length(mesh.vertices.size(), 0);
  for_each_nearest(mesh.vertices, points, [&](std::size_t v, std::uint32_t point, double) { length[v] = lengths[point]; });
  const std::vector<std::uint8_t> left = Collapsing(mesh, std::move(length)).run(cancel);
  remove_triangles(mesh, left);
}

}  // namespace g3r::mesh
