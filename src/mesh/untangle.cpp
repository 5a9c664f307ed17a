#include "mesh/untangle.h"

#include "base/vector.h"
#include "mesh/constants.h"
#include "mesh/half_edges.h"
#include "mesh/self_intersections.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace g3r::mesh {
namespace {

// Rounds of moving vertices of crossing triangles: what still crosses after them hardly comes apart. From the first of the later ones on
// the vertices around move too: it smooths more, and is for few crossings, not for where most stay as they are.
constexpr int kFirstLater = 4;
constexpr int kRounds = kRings * kFirstLater;
// The cosine between normals below which two triangles fold back, at a dihedral angle of less than 60 degrees: creases are duller.
constexpr double kFold = -0.5;

// Marks the corners of all triangles that have a marked corner.
void grow(const Mesh& mesh, std::vector<std::uint8_t>& marked) {
  std::vector<std::uint8_t> next = marked;
  for (const auto& t : mesh.triangles) {
    if (marked[t[0]] == 0 && marked[t[1]] == 0 && marked[t[2]] == 0) continue;
    for (const std::uint32_t v : t) next[v] = 1;
  }
  marked = std::move(next);
}

// The triangles whose corners are all marked, as a mesh of their own.
struct Part {
  Mesh mesh;
  std::vector<std::uint32_t> vertex;  // of the whole mesh, for each of the part's
};

Part part_of(const Mesh& mesh, const std::vector<std::uint8_t>& marked) {
  Part part;
  std::vector<std::uint32_t> number(mesh.vertices.size(), kNone);
  for (const auto& t : mesh.triangles) {
    if (marked[t[0]] == 0 || marked[t[1]] == 0 || marked[t[2]] == 0) continue;
    auto& added = part.mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number[t[k]];
      if (n == kNone) {
        n = static_cast<std::uint32_t>(part.vertex.size());
        part.vertex.push_back(t[k]);
        part.mesh.vertices.push_back(mesh.vertices[t[k]]);
      }
      added[k] = n;
    }
  }
  return part;
}

// Marks number(v) for the corners v of all triangles of the pairs.
template <class Number>
void mark_corners(const Mesh& mesh, const std::vector<TrianglePair>& pairs, const Number& number, std::vector<std::uint8_t>& marked) {
  for (const TrianglePair& pair : pairs) {
    for (const std::uint32_t f : pair) {
      for (const std::uint32_t v : mesh.triangles[f]) marked[number(v)] = 1;
    }
  }
}

// `move`: by vertex of the whole mesh.
void smooth(Part& part, const std::vector<std::uint8_t>& move) {
  std::vector<Vec3>& at = part.mesh.vertices;
  std::vector<Vec3> sum(at.size(), Vec3{0, 0, 0});
  std::vector<double> count(at.size(), 0);
  for (const auto& t : part.mesh.triangles) {  // every neighbour twice, once for each triangle at the edge
    for (std::size_t k = 0; k < 3; ++k) {
      for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) sum[t[k]] = vector::add(sum[t[k]], at[t[other]]);
      count[t[k]] += 2;
    }
  }
  for (std::size_t v = 0; v < at.size(); ++v) {
    if (move[part.vertex[v]] == 0) continue;
    at[v] = vector::add(vector::scale(at[v], 1 - kSmoothingStep), vector::scale(sum[v], kSmoothingStep / count[v]));
  }
}

Vec3 normal_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return vector::normalised(vector::cross(vector::subtract(mesh.vertices[t[1]], a), vector::subtract(mesh.vertices[t[2]], a)));
}

// Marks the vertices at which two triangles may fold back: then one is turned from their mean by half of that angle or more.
std::vector<std::uint8_t> pointed_vertices(const Mesh& mesh) {
  std::vector<Vec3> mean(mesh.vertices.size(), Vec3{0, 0, 0});
  for (const auto& t : mesh.triangles) {
    const Vec3 n = normal_of(mesh, t);
    for (const std::uint32_t v : t) mean[v] = vector::add(mean[v], n);
  }
  for (Vec3& n : mean) n = vector::normalised(n);
  std::vector<std::uint8_t> out(mesh.vertices.size(), 0);
  const double half = std::sqrt((1 + kFold) / 2);
  for (const auto& t : mesh.triangles) {
    const Vec3 n = normal_of(mesh, t);
    for (const std::uint32_t v : t) {
      if (!(vector::dot(mean[v], n) > half)) out[v] = 1;
    }
  }
  return out;
}

// Marks, by vertex of the whole mesh, the ends of edges of the part at which two triangles fold back.
void mark_thorns(const Part& part, std::vector<std::uint8_t>& marked) {
  for_each_edge(part.mesh, [&](const HalfEdge* half_edges, std::size_t count) {
    if (count != 2) return;  // the rim of the part
    const auto normal = [&](std::size_t k) { return normal_of(part.mesh, part.mesh.triangles[half_edges[k].corner / 3]); };
    if (vector::dot(normal(0), normal(1)) < kFold) marked[part.vertex[half_edges[0].low]] = marked[part.vertex[half_edges[0].high]] = 1;
  });
}

}  // namespace

void soften_thorns(Mesh& mesh, std::size_t crossings, const std::atomic<bool>* cancel) {
  std::vector<std::uint8_t> move(mesh.vertices.size(), 0), near = pointed_vertices(mesh);
  grow(mesh, near);
  mark_thorns(part_of(mesh, near), move);
  if (std::find(move.begin(), move.end(), std::uint8_t{1}) == move.end()) return;
  std::vector<std::uint8_t> inner = move;
  for (int ring = 1; ring < kRings; ++ring) grow(mesh, inner);
  near = inner;
  grow(mesh, near);
  Part part = part_of(mesh, near);
  std::vector<Vec3>& at = part.mesh.vertices;
  const std::vector<Vec3> home = at;
  // As many rounds as rings feel them: what still folds after them is a blade, and would become shorter.
  for (int round = 0; round < kRings; ++round) {
    smooth(part, move);
    std::fill(move.begin(), move.end(), std::uint8_t{0});
    mark_thorns(part, move);
    for (std::size_t v = 0; v < move.size(); ++v) move[v] &= inner[v];
  }
  const auto put = [&] {
    for (std::size_t i = 0; i < at.size(); ++i) mesh.vertices[part.vertex[i]] = at[i];
  };
  // Where more triangles intersect than before, the surface stays as it was; everywhere, if that does not help: others may intersect too.
  std::vector<std::uint8_t> back(mesh.vertices.size(), 0);
  for (int attempt = 0; attempt <= kRings; ++attempt) {
    put();
    const std::vector<TrianglePair> pairs = self_intersections(mesh, cancel);
    if (pairs.size() <= crossings) return;
    mark_corners(
        mesh, pairs, [](std::uint32_t v) { return v; }, back);
    grow(mesh, back);
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = back[part.vertex[i]] != 0 ? home[i] : at[i];
  }
  at = home;
  put();
}

std::size_t untangle(Mesh& mesh, const std::atomic<bool>* cancel, const std::vector<std::uint8_t>& fixed) {
  std::vector<TrianglePair> pairs = self_intersections(mesh, cancel);
  std::vector<std::uint8_t> crossing(mesh.vertices.size(), 0);
  mark_corners(
      mesh, pairs, [](std::uint32_t v) { return v; }, crossing);
  const std::size_t first = pairs.size();
  std::size_t fewest = first;
  std::vector<Vec3> best = mesh.vertices;
  for (int round = 0; round < kRounds && !pairs.empty(); ++round) {
    if (cancel != nullptr && cancel->load()) throw Cancelled();
    if (round == kFirstLater && 2 * fewest > first) break;
    std::vector<std::uint8_t> move = crossing;
    if (round >= kFirstLater) grow(mesh, move);
    std::vector<std::uint8_t> near = move;
    for (std::size_t v = 0; v < fixed.size(); ++v) {
      if (fixed[v] != 0) move[v] = 0;
    }
    for (int ring = 0; ring < kRings; ++ring) grow(mesh, near);
    Part part = part_of(mesh, near);
    smooth(part, move);
    for (std::size_t i = 0; i < part.vertex.size(); ++i) mesh.vertices[part.vertex[i]] = part.mesh.vertices[i];
    pairs = self_intersections(part.mesh, cancel);
    std::fill(crossing.begin(), crossing.end(), 0);
    mark_corners(
        part.mesh, pairs, [&](std::uint32_t v) { return part.vertex[v]; }, crossing);
    if (pairs.size() >= fewest) continue;
    fewest = pairs.size();
    best = mesh.vertices;
  }
  mesh.vertices = std::move(best);
  return fewest;
}

}  // namespace g3r::mesh
