#include "mesh/trim.h"

#include "base/disjoint_sets.h"
#include "base/median.h"
#include "base/pair_key.h"
#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/distance_to_points.h"
#include "mesh/lines.h"
#include "mesh/mesh_parts.h"
#include "mesh/smooth_rims.h"
#include "mesh/triangle.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>

namespace g3r::mesh {
namespace {

// How far from each point surface may be, in its own units. Farther than four spacings of the cloud nobody measured anything; where it is
// sparse, but a surface, the gaps between its points are no holes, nor are those between lines.
std::vector<double> limits_of(const OrientedPoints& points, const MeshOptions& options) {
  if (options.trim == MeshOptions::Trim::kDistance) return std::vector<double>(points.spacing.size(), options.trim_distance);
  const std::vector<double> spacing = spacing_across_lines(points.positions, points.spacing);
  const double typical = median(spacing);
  std::vector<double> limits(spacing.size());
  for (std::size_t i = 0; i < limits.size(); ++i) limits[i] = std::max(kFarSpacings * std::min(spacing[i], typical), kGap * spacing[i]);
  return limits;
}

double longest_side(const std::array<Vec3, 3>& corner) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = vector::subtract(corner[(k + 1) % 3], corner[k]);
    longest = std::max(longest, std::sqrt(vector::dot(side, side)));
  }
  return longest;
}

// Marks the triangles that have no place farther than the limits but what is cut off with a corner. Small ones are judged by their corners,
// large ones by the middles of their sides and their centre as well. `off`: which vertices are farther.
std::vector<std::uint8_t> triangles_within(const Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& limits,
                                           const std::vector<std::uint8_t>& off, const std::atomic<bool>* cancel) {
  // No place of a smaller triangle is much farther from a point than its corners.
  const double small = 0.5 * *std::min_element(limits.begin(), limits.end());
  std::vector<std::uint8_t> keep(mesh.triangles.size(), 1);
  std::vector<Vec3> places;
  std::vector<std::uint32_t> asker;
  for (std::uint32_t t = 0; t < keep.size(); ++t) {
    const Triangle& v = mesh.triangles[t];
    if (off[v[0]] + off[v[1]] + off[v[2]] > 0) continue;
    const std::array<Vec3, 3> corner{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
    if (longest_side(corner) <= small) continue;
    for (std::size_t k = 0; k < 3; ++k) places.push_back(vector::scale(vector::add(corner[k], corner[(k + 1) % 3]), 0.5));
    places.push_back(centre_of(mesh, v));
    asker.resize(places.size(), t);
  }
  const std::vector<double> distance = distance_to_points(
      places, points, [&](std::uint32_t i) { return limits[i]; }, cancel);
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (distance[k] > 1) keep[asker[k]] = 0;
  }
  return keep;
}

// The vertices in the middles of edges, by the keys of these.
using Middles = std::unordered_map<std::uint64_t, std::uint32_t>;

// Makes vertices in the middles of the edges that are longer than `longest` and of triangles with a side so long through which the surface
// `limit` away from the points may pass: no place of a triangle is farther from a corner than its longest side.
Middles halve_long_edges(Mesh& mesh, const std::vector<Vec3>& points, double limit, double longest, const std::atomic<bool>* cancel) {
  const auto squared_length = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 d = vector::subtract(mesh.vertices[a], mesh.vertices[b]);
    return vector::dot(d, d);
  };
  Middles middle;
  const std::vector<double> distance = distance_to_points(
      mesh.vertices, points, [](std::uint32_t) { return 1.0; }, cancel);
  for (const Triangle& v : mesh.triangles) {
    const double side = longest_side({mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]});
    const auto [near, far] = std::minmax({distance[v[0]], distance[v[1]], distance[v[2]]});
    if (side <= longest || near > limit + side || far < limit - side) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      if (squared_length(a, b) <= longest * longest || !middle.try_emplace(unordered_pair_key(a, b), mesh.vertices.size()).second) continue;
      mesh.vertices.push_back(vector::scale(vector::add(mesh.vertices[a], mesh.vertices[b]), 0.5));
    }
  }
  return middle;
}

// Cuts every triangle into as many as one more than its sides have middles.
void cut_at_middles(Mesh& mesh, const Middles& middle) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const Triangle v = mesh.triangles[t];
    std::vector<std::uint32_t> ring;  // corners and middles
    std::size_t first = 0;            // a middle, if there is one
    for (std::size_t k = 0; k < 3; ++k) {
      ring.push_back(v[k]);
      const auto found = middle.find(unordered_pair_key(v[k], v[(k + 1) % 3]));
      if (found == middle.end()) continue;
      first = ring.size();
      ring.push_back(found->second);
    }
    if (ring.size() == 3) continue;
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(first), ring.end());
    if (ring.size() == 6) {
      mesh.triangles[t] = {ring[0], ring[2], ring[4]};
      for (std::size_t k = 0; k < 6; k += 2) mesh.triangles.push_back({ring[k], ring[k + 1], ring[(k + 2) % 6]});
      continue;
    }
    mesh.triangles[t] = {ring[0], ring[1], ring[2]};
    for (std::size_t k = 2; k + 1 < ring.size(); ++k) mesh.triangles.push_back({ring[0], ring[k], ring[k + 1]});
  }
}

// Halves edges that are longer than half of the limit, and than leaves around points, where surface may go on on both sides of the limit,
// so that what is cut there follows it.
void halve_edges(Mesh& mesh, const OrientedPoints& points, double limit, const std::atomic<bool>* cancel) {
  const double longest = std::max(limit / 2, kFinestCell * median(points.spacing));
  for (bool is_halved = true; is_halved;) {
    const Middles middle = halve_long_edges(mesh, points.positions, limit, longest, cancel);
    cut_at_middles(mesh, middle);
    is_halved = !middle.empty();
  }
}

// How far past the rims of the points each vertex is: 0 at a rim, -1 amid points.
//   past = |m x n| / (sqrt(2 / pi) s) + |n| - n . (normal of the vertex) - 1
// with m and n the means of the offsets and normals of the points around it, weighed with the area that each stands for and a Gaussian of
// width s = kGap spacings: at the rim of a flat half plane |m| = sqrt(2 / pi) s. Across creases m and n are parallel, at the edges of thin
// parts n is short, and surface that closes the scan is turned away from n. What is farther than s from every point is past them too.
std::vector<double> past_rims(const Mesh& mesh, const OrientedPoints& points, const std::atomic<bool>* cancel) {
  const std::vector<double> width = spacing_across_lines(points.positions, points.spacing);
  const std::vector<Vec3> normals = vertex_normals(mesh);
  const Neighbours neighbours(points.positions);
  std::vector<double> past(mesh.vertices.size());
  const auto past_of = [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    std::vector<double> squared;
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3& x = mesh.vertices[v];
      neighbours.nearest(x, 1, near, squared);
      const double s = kGap * width[near[0]], far = std::sqrt(squared[0]) / s - 1;
      neighbours.within(x, kFarSpacings * width[near[0]], near);  // beyond, weights are below 2 %
      std::sort(near.begin(), near.end());                        // the sums do not depend on the order of the search
      Vec3 m{0, 0, 0}, n{0, 0, 0};
      double total = 0;
      for (const std::uint32_t j : near) {
        const Vec3 d = vector::subtract(points.positions[j], x);
        const double w = points.spacing[j] * points.spacing[j] * std::exp(-vector::dot(d, d) / (2 * s * s));
        m = vector::add(m, vector::scale(d, w));
        n = vector::add(n, vector::scale(points.normals[j], w));
        total += w;
      }
      past[v] = far;
      if (total <= 0) continue;
      n = vector::scale(n, 1 / total);
      const Vec3 across = vector::cross(vector::scale(m, 1 / total), n);
      const double aside = std::sqrt(vector::dot(across, across)) / (std::sqrt(2 / std::numbers::pi) * s);
      past[v] = std::max(far, aside + std::sqrt(vector::dot(n, n)) - vector::dot(n, normals[v]) - 1);
    }
  };
  parallel::for_blocks(past.size(), parallel::kSmallBlock, past_of, cancel);
  return past;
}

// From the marked vertices on over all that are past 0.
void flood(const Mesh& mesh, const std::vector<double>& past, std::vector<std::uint8_t>& off) {
  DisjointSets regions(off.size());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (past[t[k]] > 0 && past[t[(k + 1) % 3]] > 0) regions.join(t[k], t[(k + 1) % 3]);
    }
  }
  std::vector<std::uint8_t> is_off(off.size(), 0);
  for (std::uint32_t v = 0; v < off.size(); ++v) {
    if (off[v] != 0) is_off[regions.find(v)] = 1;
  }
  for (std::uint32_t v = 0; v < off.size(); ++v) off[v] = is_off[regions.find(v)];
}

// A vertex that is made on the edge of two others, so far on the way.
struct Cut {
  std::uint32_t in = 0, vertex = 0;
};

// Halves the way of cuts that are beyond the limits to the vertices within them, as the distance does not grow evenly along an edge.
void draw_in(Mesh& mesh, std::vector<Cut> cuts, const std::vector<Vec3>& points, const std::vector<double>& limits,
             const std::atomic<bool>* cancel) {
  for (double way = 1; way > kAtOnePlace && !cuts.empty(); way /= 2) {
    std::vector<Vec3> places;
    places.reserve(cuts.size());
    for (const Cut& cut : cuts) places.push_back(mesh.vertices[cut.vertex]);
    const std::vector<double> distance = distance_to_points(
        places, points, [&](std::uint32_t i) { return limits[i]; }, cancel);
    std::size_t left = 0;
    for (std::size_t k = 0; k < cuts.size(); ++k) {
      if (distance[k] <= 1) continue;
      Vec3& at = mesh.vertices[cuts[k].vertex];
      at = vector::scale(vector::add(at, mesh.vertices[cuts[k].in]), 0.5);
      cuts[left++] = cuts[k];
    }
    cuts.resize(left);
  }
}

// Cuts the marked vertices off, where `past` is 0 on the edges to the others. `keep`: by triangle. Returns the cuts.
std::vector<Cut> cut_off(Mesh& mesh, const std::vector<double>& past, const std::vector<std::uint8_t>& off,
                         std::vector<std::uint8_t>& keep) {
  std::vector<Cut> cuts;
  std::unordered_map<std::uint64_t, std::uint32_t> made;
  const auto cut = [&](std::uint32_t in, std::uint32_t out) {
    const auto [place, is_new] = made.try_emplace(pair_key(in, out), static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) {
      const double t = std::clamp(past[in] / (past[in] - past[out]), kAtOnePlace, 1 - kAtOnePlace);
      mesh.vertices.push_back(vector::add(vector::scale(mesh.vertices[in], 1 - t), vector::scale(mesh.vertices[out], t)));
      cuts.push_back({in, place->second});
    }
    return place->second;
  };
  const auto add = [&](const Triangle& t) {
    mesh.triangles.push_back(t);
    keep.push_back(1);
  };
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    Triangle v = mesh.triangles[t];
    const int outside = off[v[0]] + off[v[1]] + off[v[2]];
    if (keep[t] == 0 || outside == 0) continue;
    keep[t] = 0;
    if (outside == 3) continue;
    const std::uint8_t single = outside == 1 ? 1 : 0;  // the corner on its own side goes first
    while (off[v[0]] != single) std::rotate(v.begin(), v.begin() + 1, v.end());
    if (outside == 2) {
      add({v[0], cut(v[0], v[1]), cut(v[0], v[2])});
    } else {
      const std::uint32_t p = cut(v[1], v[0]), q = cut(v[2], v[0]);
      add({p, v[1], v[2]});
      add({p, v[2], q});
    }
  }
  return cuts;
}

}  // namespace

bool trim(Mesh& mesh, const OrientedPoints& points, const MeshOptions& options, const std::atomic<bool>* cancel) {
  const std::vector<double> limits = limits_of(points, options);
  const auto limit = [&](std::uint32_t i) { return limits[i]; };
  std::vector<double> past;
  std::vector<std::uint8_t> off, keep;
  const auto look = [&] {
    past = distance_to_points(mesh.vertices, points.positions, limit, cancel);
    for (double& d : past) d -= 1;
    off.resize(past.size());
    std::transform(past.begin(), past.end(), off.begin(), [](double d) { return d > 0 ? 1 : 0; });
    keep = triangles_within(mesh, points.positions, limits, off, cancel);
  };
  look();
  const auto is_set = [](std::uint8_t byte) { return byte != 0; };
  if (std::none_of(off.begin(), off.end(), is_set) && std::all_of(keep.begin(), keep.end(), is_set)) return false;
  if (options.trim == MeshOptions::Trim::kDistance) {
    halve_edges(mesh, points, options.trim_distance, cancel);
    look();
  }
  if (options.trim == MeshOptions::Trim::kAuto) {
    const std::vector<double> rims = past_rims(mesh, points, cancel);
    for (std::size_t v = 0; v < past.size(); ++v) past[v] = std::max(past[v], rims[v]);
    for (std::size_t t = 0; t < keep.size(); ++t) {
      for (const std::uint32_t v : mesh.triangles[t]) {
        if (keep[t] == 0 && past[v] > 0) off[v] = 1;
      }
    }
    flood(mesh, past, off);
  }
  draw_in(mesh, cut_off(mesh, past, off, keep), points.positions, limits, cancel);
  remove_triangles(mesh, keep);
  if (mesh.triangles.empty()) throw InvalidInput("trimming removed the whole mesh: the trim distance is too small");
  smooth_rims(mesh, [&](const std::vector<Vec3>& places) {
    std::vector<std::uint8_t> near(places.size());
    const std::vector<double> distance = distance_to_points(places, points.positions, limit, cancel);
    std::transform(distance.begin(), distance.end(), near.begin(), [](double d) { return d <= 1 ? 1 : 0; });
    return near;
  });
  return true;
}

}  // namespace g3r::mesh
