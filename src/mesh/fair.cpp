#include "mesh/fair.h"

#include "base/disjoint_sets.h"
#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/distance_to_points.h"
#include "mesh/least_squares_mesh.h"
#include "mesh/mesh_parts.h"
#include "mesh/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace g3r::mesh {
namespace {

using vector::add;
using vector::dot;
using vector::scale;
using vector::subtract;

// Rounds of finding where the points meet the surface, which moves in each.
constexpr int kMeetings = 3;

// Barycentric coordinates of the point of a triangle that is nearest to p. Ericson, "Real-time collision detection", 5.1.5.
std::array<double, 3> nearest_in(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = subtract(b, a), ac = subtract(c, a), ap = subtract(p, a), bp = subtract(p, b), cp = subtract(p, c);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double all = va + vb + vc;
  if (!(all > 0)) return {1, 0, 0};
  return {va / all, vb / all, vc / all};
}

// Where the marked points meet the surface.
std::vector<Anchor> anchors_on(const Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::uint8_t>& marked) {
  const std::vector<Vec3> centres = centres_of(mesh);
  const Neighbours neighbours(centres);
  std::vector<Anchor> anchors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (marked[i] != 0) anchors.push_back({{}, {}, points[i]});
  }
  parallel::for_blocks(anchors.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) {
      neighbours.nearest(anchors[i].point, kFitPoints, index, squared);  // of long triangles the centres are far
      double best = std::numeric_limits<double>::infinity();
      for (const std::uint32_t t : index) {
        const auto& v = mesh.triangles[t];
        const std::array<Vec3, 3> corner{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
        const std::array<double, 3> weight = nearest_in(anchors[i].point, corner[0], corner[1], corner[2]);
        Vec3 d = scale(anchors[i].point, -1);
        for (std::size_t k = 0; k < 3; ++k) d = add(d, scale(corner[k], weight[k]));
        if (dot(d, d) >= best) continue;
        best = dot(d, d);
        anchors[i].vertex = v;
        anchors[i].weight = weight;
      }
    }
  });
  return anchors;
}

// The free vertices to which one of the marked points is the nearest.
std::vector<std::uint8_t> vertices_at(const Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::uint8_t>& marked) {
  std::vector<std::uint8_t> free(mesh.vertices.size(), 0);
  for_each_nearest(mesh.vertices, points, [&](std::size_t v, std::uint32_t point, double) { free[v] = marked[point]; });
  return free;
}

// Connected regions of free vertices.
class Regions {
 public:
  Regions(const VertexRings& rings, const std::vector<std::uint8_t>& free) : free_(free), sets_(free.size()) {
    for (std::uint32_t v = 0; v < free.size(); ++v) {
      if (free[v] == 0) continue;
      for (const std::uint32_t other : rings.of(v)) {
        if (free[other] != 0) sets_.join(v, other);
      }
    }
  }

  // Of the regions in which more triangles intersect than before.
  void take_back(Mesh& mesh, const std::vector<TrianglePair>& before, const std::vector<TrianglePair>& after,
                 const std::vector<Vec3>& home) {
    const std::vector<std::size_t> least = corners_in(mesh, before), now = corners_in(mesh, after);
    for (std::uint32_t v = 0; v < free_.size(); ++v) {
      if (free_[v] != 0 && now[sets_.find(v)] > least[sets_.find(v)]) mesh.vertices[v] = home[v];
    }
  }

 private:
  // Of the triangles of the pairs, for each region at its first vertex.
  [[nodiscard]] std::vector<std::size_t> corners_in(const Mesh& mesh, const std::vector<TrianglePair>& pairs) {
    std::vector<std::size_t> out(free_.size(), 0);
    for (const TrianglePair& pair : pairs) {
      for (const std::uint32_t f : pair) {
        for (const std::uint32_t v : mesh.triangles[f]) out[sets_.find(v)] += free_[v] != 0 ? 1 : 0;
      }
    }
    return out;
  }

  const std::vector<std::uint8_t>& free_;
  DisjointSets sets_;
};

// The vertices of triangles that intersect are free no more, and some rings around them.
void hold_around(const Mesh& mesh, const std::vector<TrianglePair>& pairs, const VertexRings& rings, std::vector<std::uint8_t>& free) {
  std::vector<std::uint32_t> front, next;
  for (const TrianglePair& pair : pairs) {
    for (const std::uint32_t f : pair) front.insert(front.end(), mesh.triangles[f].begin(), mesh.triangles[f].end());
  }
  for (int ring = 0; ring <= kRings; ++ring, front.swap(next)) {
    next.clear();
    for (const std::uint32_t v : front) {
      free[v] = 0;
      const auto around = rings.of(v);
      next.insert(next.end(), around.begin(), around.end());
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
  }
}

}  // namespace

void make_fair(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::uint8_t>& in_lines, const std::atomic<bool>* cancel) {
  if (mesh.triangles.empty() || std::none_of(in_lines.begin(), in_lines.end(), [](std::uint8_t m) { return m != 0; })) return;
  std::vector<std::uint8_t> free = vertices_at(mesh, points, in_lines);
  const VertexRings rings = vertex_rings(mesh);
  const std::vector<Vec3> home = mesh.vertices;
  const std::vector<TrianglePair> before = self_intersections(mesh, cancel);
  std::optional<double> enough;
  // Each attempt holds what crossed in the one before, and the rings around it; after as many as there are rings it stays.
  for (int attempt = 1;; ++attempt) {
    LeastSquaresMesh surface(rings, free);
    for (int meeting = 0; meeting < kMeetings; ++meeting)
      surface.minimise(anchors_on(mesh, points, in_lines), mesh.vertices, enough, cancel);
    const std::vector<TrianglePair> after = self_intersections(mesh, cancel);
    if (after.size() <= before.size()) return;
    if (attempt > kRings) {
      Regions(rings, free).take_back(mesh, before, after, home);
      return;
    }
    hold_around(mesh, after, rings, free);
    mesh.vertices = home;
  }
}

}  // namespace g3r::mesh
