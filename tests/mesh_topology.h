// An independent check of small meshes for tests: counts what is wrong by looking every edge and every fan up in maps.
#pragma once

#include <g3r/mesh.h>

#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <vector>

namespace g3r::testing {

struct Topology {
  std::size_t bad_edges = 0;     ///< directed edges that do not have exactly one opposite
  std::size_t bad_vertices = 0;  ///< used vertices whose triangles do not form exactly one closed fan
  std::size_t components = 0;
  long genus = 0;  ///< sum over components, for closed manifolds
  double volume = 0;
};

inline Topology topology(const Mesh& mesh) {
  Topology out;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(mesh.vertices.size());  // link of each vertex: next[v][a] = b
  std::vector<std::size_t> fan(mesh.vertices.size(), 0), group(mesh.vertices.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      ++directed[{a, b}];
      next[a][b] = c;
      ++fan[a];
      group[find(a)] = find(b);
    }
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    out.volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
  }
  for (const auto& [edge, count] : directed) {
    const auto opposite = directed.find({edge.second, edge.first});
    if (edge.first == edge.second || count != 1 || opposite == directed.end() || opposite->second != 1) ++out.bad_edges;
  }
  std::set<std::size_t> roots;
  long vertices = 0;
  for (std::size_t v = 0; v < fan.size(); ++v) {
    if (fan[v] == 0) continue;
    ++vertices;
    roots.insert(find(v));
    std::size_t steps = 0;
    std::uint32_t at = next[v].begin()->first;
    do {
      const auto found = next[v].find(at);
      if (found == next[v].end()) break;
      at = found->second;
      ++steps;
    } while (at != next[v].begin()->first && steps <= fan[v]);
    if (steps != fan[v] || next[v].size() != fan[v]) ++out.bad_vertices;
  }
  out.components = roots.size();
  const auto faces = static_cast<long>(mesh.triangles.size());
  out.genus = static_cast<long>(out.components) - (vertices - faces * 3 / 2 + faces) / 2;
  return out;
}

}  // namespace g3r::testing
