#include "mesh/coarsen.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/distance_to_points.h"
#include "mesh/edge_collapse.h"
#include "mesh/mesh_parts.h"
#include "mesh/quadric.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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

// Collapses what is flat and shorter than asked for.
class Coarsening {
 public:
  Coarsening(Mesh& mesh, std::vector<double> length)
      : mesh_(mesh),
        edges_(mesh),
        origin_(mesh.vertices[mesh.triangles.front()[0]]),
        length_(std::move(length)),
        quadric_(mesh.vertices.size()) {
    for (const auto& t : mesh.triangles) {
      if (std::none_of(t.begin(), t.end(), [&](std::uint32_t v) { return length_[v] > 0; })) continue;
      const Vec3 n = edges_.normal_of(t);
      const double area = std::sqrt(dot(n, n));
      if (!(area > 0)) continue;
      const Vec3 unit = vector::scale(n, 1 / area);
      for (const std::uint32_t v : t) quadric_[v].add_plane(unit, -dot(unit, subtract(mesh.vertices[t[0]], origin_)), area);
    }
  }

  // Returns which triangles are left.
  const std::vector<std::uint8_t>& run(const std::atomic<bool>* cancel) {
    for (const auto& t : mesh_.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        if (a < b) push(a, b);
      }
    }
    for (std::size_t count = 0; !queue_.empty(); ++count) {
      if (count % parallel::kSmallBlock == 0 && cancel != nullptr && cancel->load()) throw Cancelled();
      const auto [squared, a, b] = queue_.top();
      queue_.pop();
      if (!edges_.is_used(a) || !edges_.is_used(b) || squared != edges_.squared_length(a, b)) continue;
      const bool forward = cost(a, b) <= cost(b, a);
      if (!collapse(forward ? a : b, forward ? b : a)) collapse(forward ? b : a, forward ? a : b);
    }
    return edges_.is_left();
  }

 private:
  using Entry = std::tuple<double, std::uint32_t, std::uint32_t>;  // squared length, low, high

  void push(std::uint32_t a, std::uint32_t b) {
    const double squared = edges_.squared_length(a, b), limit = std::min(length_[a], length_[b]);
    if (squared < limit * limit) queue_.emplace(squared, std::min(a, b), std::max(a, b));
  }
  // The mean square of the distances from the planes that both ends stand for.
  [[nodiscard]] double cost(std::uint32_t from, std::uint32_t to) const {
    Quadric both = quadric_[from];
    both.add(quadric_[to]);
    return both.weight > 0 ? both.squared_distances(subtract(mesh_.vertices[to], origin_)) / both.weight
                           : std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] bool keeps_shape(std::uint32_t from, std::uint32_t to) const {
    const double limit = std::min(length_[from], length_[to]), longest = 2 * limit;  // as in a leaf's diagonals
    if (cost(from, to) > kTolerance * kTolerance * limit * limit) return false;
    Vec3 mean{0, 0, 0};
    edges_.for_triangles_of(from, [&](const auto& t) {
      mean = vector::add(mean, edges_.normal_of(t));
      return true;
    });
    mean = vector::normalised(mean);
    return edges_.for_triangles_of(from, [&](const std::array<std::uint32_t, 3>& t) {
      if (!(dot(mean, vector::normalised(edges_.normal_of(t))) >= kTurn)) return false;
      if (std::find(t.begin(), t.end(), to) != t.end()) return true;
      if (!(dot(mean, vector::normalised(edges_.normal_of(t, from, to))) >= kTurn)) return false;
      return std::all_of(t.begin(), t.end(),
                         [&](std::uint32_t v) { return v == from || edges_.squared_length(v, to) <= longest * longest; });
    });
  }

  bool collapse(std::uint32_t from, std::uint32_t to) {
    if (!keeps_shape(from, to) || !edges_.collapse(from, to)) return false;
    quadric_[to].add(quadric_[from]);
    for (const std::uint32_t v : edges_.neighbours()) {
      if (v != to) push(to, v);
    }
    return true;
  }

  Mesh& mesh_;
  EdgeCollapse edges_;
  Vec3 origin_;  // of the quadrics: far from 0 they would cancel
  std::vector<double> length_;
  std::vector<Quadric> quadric_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
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
  Coarsening coarsening(mesh, std::move(length));
  remove_triangles(mesh, coarsening.run(cancel));
}

}  // namespace g3r::mesh
