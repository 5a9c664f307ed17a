#include "mesh/fair.h"

#include "base/disjoint_sets.h"
#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/mesh_parts.h"
#include "mesh/self_intersections.h"

#include <g3r/error.h>

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
constexpr int kRounds = 3;
// Conjugate gradients in each: so many steps at most, or until the residual is this share of that of the surface as it was. What is left
// moves no vertex visibly.
constexpr int kSteps = 300;
constexpr double kTolerance = 1e-4;

// A point, and where the surface should meet it.
struct Pin {
  std::array<std::uint32_t, 3> vertex{};
  std::array<double, 3> weight{};
  Vec3 place{};
};

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

// The vertices of the mesh around each one, once each.
struct Rings {
  std::vector<std::uint32_t> begin, vertex;
};

Rings rings_of(const Mesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
  sides.reserve(6 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      sides.emplace_back(t[k], t[(k + 1) % 3]);
      sides.emplace_back(t[(k + 1) % 3], t[k]);
    }
  }
  std::sort(sides.begin(), sides.end());
  sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
  Rings rings;
  rings.begin.assign(mesh.vertices.size() + 1, 0);
  for (const auto& [from, to] : sides) {
    ++rings.begin[from + 1];
    rings.vertex.push_back(to);
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) rings.begin[v + 1] += rings.begin[v];
  return rings;
}

// The quadratic energy of displacements of the free vertices.
class Energy {
 public:
  Energy(const Rings& rings, const std::vector<std::uint8_t>& free) : rings_(rings), free_(free) {
    counts_.resize(free.size(), 0);
    inverse_.resize(free.size(), 0);
    for (std::uint32_t v = 0; v < free.size(); ++v) {
      bool near = free[v] != 0;
      for (std::uint32_t k = rings.begin[v]; k < rings.begin[v + 1]; ++k) near = near || free[rings.vertex[k]] != 0;
      counts_[v] = near ? 1 : 0;
      inverse_[v] = 1.0 / std::max(1U, rings.begin[v + 1] - rings.begin[v]);
    }
  }

  // Half the gradient at the positions, 0 at the vertices that stay. `home`: subtract the places of the pins.
  void gradient(const std::vector<Vec3>& at, const std::vector<Pin>& pins, bool home, std::vector<Vec3>& out) {
    const std::size_t n = at.size();
    shares_.resize(n, Vec3{0, 0, 0});
    out.resize(n, Vec3{0, 0, 0});
    parallel::for_blocks(n, kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        if (counts_[v] != 0) shares_[v] = scale(subtract(at[v], mean(at, v)), inverse_[v]);
      }
    });
    parallel::for_blocks(n, kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        if (free_[v] == 0) continue;
        out[v] = scale(shares_[v], rings_.begin[v + 1] - rings_.begin[v]);
        for (std::uint32_t k = rings_.begin[v]; k < rings_.begin[v + 1]; ++k) out[v] = subtract(out[v], shares_[rings_.vertex[k]]);
      }
    });
    // The distance of a point from the surface weighs half as much as the Laplacian of a vertex: less smooths, and leaves the points.
    for (const Pin& pin : pins) {
      Vec3 miss = home ? scale(pin.place, -1) : Vec3{0, 0, 0};
      for (std::size_t k = 0; k < 3; ++k) miss = add(miss, scale(at[pin.vertex[k]], pin.weight[k]));
      for (std::size_t k = 0; k < 3; ++k) {
        if (free_[pin.vertex[k]] != 0) out[pin.vertex[k]] = add(out[pin.vertex[k]], scale(miss, 0.5 * pin.weight[k]));
      }
    }
  }

 private:
  [[nodiscard]] Vec3 mean(const std::vector<Vec3>& at, std::size_t v) const {
    Vec3 sum{0, 0, 0};
    for (std::uint32_t k = rings_.begin[v]; k < rings_.begin[v + 1]; ++k) sum = add(sum, at[rings_.vertex[k]]);
    return scale(sum, inverse_[v]);
  }

  const Rings& rings_;
  const std::vector<std::uint8_t>& free_;
  std::vector<std::uint8_t> counts_;  // vertices whose Laplacian is part of the energy
  std::vector<double> inverse_;       // of the number of neighbours of each vertex
  std::vector<Vec3> shares_;          // of each neighbour, in the Laplacian of a vertex; 0 where that does not count
};

double product(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return parallel::sum_blocks(a.size(), kBlock, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += dot(a[i], b[i]);
    return sum;
  });
}

// Conjugate gradients from where the vertices are, until the squared residual is at most `enough`; if that is nothing yet, it follows from
// the first.
void minimise(Energy& energy, const std::vector<Pin>& pins, std::vector<Vec3>& at, std::optional<double>& enough,
              const std::atomic<bool>* cancel) {
  std::vector<Vec3> residual, image;
  energy.gradient(at, pins, true, residual);
  for (Vec3& r : residual) r = scale(r, -1);
  std::vector<Vec3> direction = residual;
  double squared = product(residual, residual);
  if (!enough) enough = kTolerance * kTolerance * squared;
  for (int step = 0; step < kSteps && squared > *enough; ++step) {
    if (cancel != nullptr && cancel->load()) throw Cancelled();
    energy.gradient(direction, pins, false, image);
    const double alpha = squared / product(direction, image);
    if (!std::isfinite(alpha)) return;
    parallel::for_all(at.size(), [&](std::size_t v) {
      at[v] = add(at[v], scale(direction[v], alpha));
      residual[v] = subtract(residual[v], scale(image[v], alpha));
    });
    const double now = product(residual, residual);
    parallel::for_all(at.size(), [&](std::size_t v) { direction[v] = add(residual[v], scale(direction[v], now / squared)); });
    squared = now;
  }
}

// Where the marked points meet the surface.
std::vector<Pin> pin(const Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::uint8_t>& marked) {
  const std::vector<Vec3> centres = centres_of(mesh);
  const Neighbours neighbours(centres);
  std::vector<Pin> pins;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (marked[i] != 0) pins.push_back({{}, {}, points[i]});
  }
  parallel::for_blocks(pins.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) {
      neighbours.nearest(pins[i].place, kFitPoints, index, squared);  // of long triangles the centres are far
      double best = std::numeric_limits<double>::infinity();
      for (const std::uint32_t t : index) {
        const auto& v = mesh.triangles[t];
        const std::array<Vec3, 3> corner{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
        const std::array<double, 3> weight = nearest_in(pins[i].place, corner[0], corner[1], corner[2]);
        Vec3 d = scale(pins[i].place, -1);
        for (std::size_t k = 0; k < 3; ++k) d = add(d, scale(corner[k], weight[k]));
        if (dot(d, d) >= best) continue;
        best = dot(d, d);
        pins[i].vertex = v;
        pins[i].weight = weight;
      }
    }
  });
  return pins;
}

// The free vertices to which one of the marked points is the nearest.
std::vector<std::uint8_t> vertices_at(const Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::uint8_t>& marked) {
  const Neighbours neighbours(points);
  std::vector<std::uint8_t> free(mesh.vertices.size(), 0);
  parallel::for_blocks(free.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t v = begin; v < end; ++v) {
      neighbours.nearest(mesh.vertices[v], 1, index, squared);
      free[v] = marked[index[0]];
    }
  });
  return free;
}

// Connected regions of free vertices.
class Regions {
 public:
  Regions(const Rings& rings, const std::vector<std::uint8_t>& free) : free_(free), sets_(free.size()) {
    for (std::uint32_t v = 0; v < free.size(); ++v) {
      for (std::uint32_t k = rings.begin[v]; free[v] != 0 && k < rings.begin[v + 1]; ++k) {
        if (free[rings.vertex[k]] != 0) sets_.join(v, rings.vertex[k]);
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
void hold_around(const Mesh& mesh, const std::vector<TrianglePair>& pairs, const Rings& rings, std::vector<std::uint8_t>& free) {
  std::vector<std::uint32_t> front, next;
  for (const TrianglePair& pair : pairs) {
    for (const std::uint32_t f : pair) front.insert(front.end(), mesh.triangles[f].begin(), mesh.triangles[f].end());
  }
  for (int ring = 0; ring <= kRings; ++ring, front.swap(next)) {
    next.clear();
    for (const std::uint32_t v : front) {
      free[v] = 0;
      next.insert(next.end(), rings.vertex.begin() + rings.begin[v], rings.vertex.begin() + rings.begin[v + 1]);
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
  }
}

}  // namespace

void make_fair(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::uint8_t>& in_lines, const std::atomic<bool>* cancel) {
  if (mesh.triangles.empty() || std::none_of(in_lines.begin(), in_lines.end(), [](std::uint8_t m) { return m != 0; })) return;
  std::vector<std::uint8_t> free = vertices_at(mesh, points, in_lines);
  const Rings rings = rings_of(mesh);
  const std::vector<Vec3> home = mesh.vertices;
  const std::vector<TrianglePair> before = self_intersections(mesh);
  std::optional<double> enough;
  // Each attempt holds what crossed in the one before, and the rings around it; after as many as there are rings it stays.
  for (int attempt = 1;; ++attempt) {
    Energy energy(rings, free);
    for (int round = 0; round < kRounds; ++round) minimise(energy, pin(mesh, points, in_lines), mesh.vertices, enough, cancel);
    const std::vector<TrianglePair> after = self_intersections(mesh);
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
