#include "mesh/smooth_rims.h"

#include "base/vector.h"
#include "mesh/constants.h"
#include "mesh/half_edges.h"
#include "mesh/triangle.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace g3r::mesh {
namespace {

using vector::add;
using vector::dot;
using vector::scale;
using vector::subtract;

// Passes of smoothing, which reaches as many edges as the root of their number: steps of the triangulation, up to three edges long, go;
// fewer leave rags, more round corners.
constexpr int kPasses = kRings * kRings;
// The mark of a vertex on the boundary; those that follow it have larger ones.
enum : std::uint8_t { kRim = 1 };

using RimEdge = std::pair<std::uint32_t, std::uint32_t>;

// Edges with one triangle, as it runs along them.
std::vector<RimEdge> boundary_of(const Mesh& mesh) {
  std::vector<RimEdge> out;
  for_each_edge(mesh, [&](const HalfEdge* half_edges, std::size_t count) {
    if (count == 1) out.emplace_back(vertex_of(mesh, half_edges->corner), vertex_of(mesh, next_corner(half_edges->corner)));
  });
  return out;
}

// The part of a mesh near its boundary.
class Rim {
 public:
  Rim(const Mesh& mesh, std::vector<RimEdge> boundary) : boundary_(std::move(boundary)), mark_(mesh.vertices.size(), 0) {
    for (const auto& [a, b] : boundary_) mark_[a] = mark_[b] = kRim;
    std::uint8_t ring = kRim;  // with none beside the rim that follow it, triangles there would be squeezed
    for (int i = 0; i < kRings; ++i, ++ring) {
      for (const auto& t : mesh.triangles) {
        if (std::none_of(t.begin(), t.end(), [&](std::uint32_t v) { return mark_[v] == ring; })) continue;
        for (const std::uint32_t v : t) mark_[v] = mark_[v] == 0 ? static_cast<std::uint8_t>(ring + 1) : mark_[v];
      }
    }
    for (const auto& t : mesh.triangles) {
      if (std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return mark_[v] != 0; })) triangles_.push_back(t);
    }
  }

  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }

  void smooth(std::vector<Vec3>& at) const {
    std::vector<Vec3> normal(at.size(), Vec3{0, 0, 0}), sum(at.size(), Vec3{0, 0, 0});
    std::vector<double> count(at.size(), 0);
    const auto see = [&](std::uint32_t v, std::uint32_t other) {
      sum[v] = add(sum[v], at[other]);
      ++count[v];
    };
    for (const auto& [a, b] : boundary_) see(a, b), see(b, a);
    for (const auto& t : triangles_) {
      const Vec3 n = twice_area_vector(at, t);
      for (std::size_t k = 0; k < 3; ++k) {
        normal[t[k]] = add(normal[t[k]], n);
        if (mark_[t[k]] == kRim) continue;
        for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) see(t[k], t[other]);
      }
    }
    for (std::uint32_t v = 0; v < at.size(); ++v) {
      if (mark_[v] == 0 || (mark_[v] == kRim && count[v] != 2)) continue;
      const Vec3 step = scale(subtract(scale(sum[v], 1 / count[v]), at[v]), kSmoothingStep);
      const Vec3 n = vector::normalised(normal[v]);
      at[v] = add(at[v], subtract(step, scale(n, dot(n, step))));
    }
  }

 private:
  std::vector<RimEdge> boundary_;
  std::vector<std::uint8_t> mark_;                       // kRim on the boundary, more inwards, 0 farther off
  std::vector<std::array<std::uint32_t, 3>> triangles_;  // with a marked corner
};

}  // namespace

void smooth_rims(Mesh& mesh, const std::function<std::vector<std::uint8_t>(const std::vector<Vec3>&)>& allowed) {
  std::vector<RimEdge> boundary = boundary_of(mesh);
  if (boundary.empty()) return;
  const Rim rim(mesh, std::move(boundary));
  std::vector<Vec3> at = mesh.vertices;
  for (int pass = 0; pass < kPasses; ++pass) rim.smooth(at);
  std::vector<std::uint32_t> moved;
  std::vector<Vec3> places;
  for (std::uint32_t v = 0; v < at.size(); ++v) {
    if (at[v] == mesh.vertices[v]) continue;
    moved.push_back(v);
    places.push_back(at[v]);
  }
  const std::vector<std::uint8_t> may = allowed(places);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    if (may[k] == 0) at[moved[k]] = mesh.vertices[moved[k]];
  }
  // The vertices of triangles that turn over go back. One that goes back may turn other triangles; at the latest all are back.
  for (bool turned = true; turned;) {
    turned = false;
    for (const auto& t : rim.triangles()) {
      if (dot(vector::normalised(twice_area_vector(at, t)), vector::normalised(twice_area_vector(mesh.vertices, t))) >= kSlant) continue;
      for (const std::uint32_t v : t) {
        turned = turned || at[v] != mesh.vertices[v];
        at[v] = mesh.vertices[v];
      }
    }
  }
  mesh.vertices = std::move(at);
}

}  // namespace g3r::mesh
