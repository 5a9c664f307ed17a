// Pass 4.
#include "base/disjoint_sets.h"
#include "io/output_file.h"
#include "mesh/field_points.h"
#include "mesh/half_edges.h"
#include "mesh/untangle.h"
#include "tiles/mesh_passes.h"
#include "tiles/parts.h"
#include "tiles/patches_file.h"

#include <algorithm>

namespace g3r::tiles {
namespace {

// The connected parts of the triangles of a tile, numbered in the order of their first vertices.
struct PartNumbers {
  std::vector<std::uint32_t> of_vertex;
  std::size_t count = 0;
};

PartNumbers number_parts(const Mesh& mesh) {
  DisjointSets sets(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  PartNumbers out;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const std::size_t first = sets.find(v);
    out.of_vertex.push_back(static_cast<std::uint32_t>(first == v ? out.count : out.of_vertex[first]));
    out.count += first == v ? 1 : 0;
  }
  return out;
}

std::vector<Vec3> strays_of(const MeshFolder& folder, std::size_t tile) {
  const RecordFile<MeshPoint> file(mesh_points_path(folder.folder, tile));
  std::vector<MeshPoint> points;
  file.append(0, file.size(), points);
  std::vector<Vec3> strays;
  for (const MeshPoint& p : points) {
    if (p.room == kStray) strays.push_back(p.position);
  }
  return strays;
}

// What holds them: areas by all points around, points and strays by those of the tile itself.
std::vector<mesh::Support> support_of(const MeshFolder& folder, std::size_t tile, const Mesh& mesh, const PartNumbers& parts,
                                      const std::vector<Vec3>& strays) {
  struct Points {
    std::vector<Vec3> positions;
    std::vector<double> spacing;
  };
  Points all;
  Points own;
  for_points_around(folder, Region(folder, tile).rings(), [&](std::size_t from, const MeshPoint& p) {
    for (Points* points : {&all, &own}) {
      if (points == &own && from != tile) continue;
      points->positions.push_back(p.position);
      points->spacing.push_back(p.spacing);
    }
  });
  std::vector<std::uint32_t> of_triangle;
  of_triangle.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) of_triangle.push_back(parts.of_vertex[t[0]]);
  std::vector<mesh::Support> support(parts.count);
  if (mesh.triangles.empty()) return support;
  const double scatter = mesh::noise_seen(folder.plan.noise) * folder.plan.spacing;
  mesh::add_areas(mesh, of_triangle, {all.positions, all.spacing, scatter}, support);
  mesh::add_points(mesh, of_triangle, {own.positions, own.spacing, scatter}, strays, support);
  return support;
}

// Marks what other tiles see too: vertices of theirs, and those at the rim of this tile's triangles.
std::vector<std::uint8_t> shared_vertices(const TileSurface& surface) {
  const Mesh& mesh = surface.mesh;
  std::vector<std::uint8_t> shared(mesh.vertices.size(), 0);
  for (std::size_t f = 0; f < surface.foreign.size(); ++f) shared[surface.own + f] = 1;
  for_each_edge(mesh, [&](const HalfEdge* half_edges, std::size_t count) {
    if (count != 2) shared[half_edges->low] = shared[half_edges->high] = 1;
  });
  return shared;
}

// Within the tile: what crosses at its rim stays.
std::vector<MovedVertex> untangle(TileSurface& surface, const std::atomic<bool>* cancel) {
  const std::vector<Vec3> before = surface.mesh.vertices;
  mesh::untangle(surface.mesh, cancel, shared_vertices(surface));
  std::vector<MovedVertex> moved;
  for (std::size_t v = 0; v < before.size(); ++v) {
    if (surface.mesh.vertices[v] == before[v]) continue;
    moved.push_back({v < surface.own ? v : v - surface.foreign.size(), surface.mesh.vertices[v]});
  }
  return moved;
}

}  // namespace

void write_parts(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel) {
  TileSurface surface = read_surface(folder, tile);
  const std::vector<MovedVertex> moved = untangle(surface, cancel);
  const Mesh& mesh = surface.mesh;
  const PartNumbers numbers = number_parts(mesh);
  const std::vector<Vec3> strays = strays_of(folder, tile);
  const std::vector<mesh::Support> support = support_of(folder, tile, mesh, numbers, strays);
  std::vector<Part> parts(numbers.count);
  for (std::size_t p = 0; p < parts.size(); ++p) parts[p].support = support[p];
  for (const auto& t : mesh.triangles) ++parts[numbers.of_vertex[t[0]]].triangles;
  const std::size_t centres = surface.own + surface.foreign.size();
  for (std::size_t v = 0; v < surface.own; ++v) ++parts[numbers.of_vertex[v]].vertices;
  for (std::size_t v = centres; v < mesh.vertices.size(); ++v) ++parts[numbers.of_vertex[v]].centres;
  std::vector<ForeignPart> foreign;
  for (std::size_t f = 0; f < surface.foreign.size(); ++f) {
    const TileSurface::Place& at = surface.foreign[f];
    foreign.push_back({at.vertex, static_cast<std::uint32_t>(at.tile), numbers.of_vertex[surface.own + f]});
  }
  std::vector<std::uint32_t> own(numbers.of_vertex.begin(), numbers.of_vertex.begin() + static_cast<std::ptrdiff_t>(surface.own));
  const PartsHeader header{parts.size(), moved.size(), foreign.size(), own.size(), strays.size()};
  io::OutputFile out(mesh_parts_path(folder.folder, tile), cancel);
  out.write(&header, sizeof header);
  out.write_records(parts);
  out.write_records(moved);
  out.write_records(foreign);
  out.write_records(own);
  out.commit();
}

}  // namespace g3r::tiles
