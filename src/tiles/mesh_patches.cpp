// Pass 3.
#include "io/output_file.h"
#include "mesh/field_corners.h"
#include "mesh/field_placement.h"
#include "tiles/mesh_passes.h"

#include <algorithm>
#include <map>

namespace g3r::tiles {
namespace {

// The sides of all corners around a tile, as their tiles say; outside where they say nothing.
std::vector<float> read_corners(const MeshFolder& folder, const Surroundings& around, std::size_t tile) {
  struct Asked {
    std::uint64_t name;
    std::uint32_t corner;
  };
  const mesh::Octree& octree = *around.octree;
  std::vector<std::vector<Asked>> asked(folder.tiles());
  for (std::uint32_t c = 0; c < octree.corner_count(); ++c) {
    if (octree.on_boundary(c)) continue;
    const auto grid = octree.corner_grid(c);
    asked[folder.owner(cell_at(grid, folder.cells.level))].push_back({corner_name(grid), c});
  }
  std::vector<float> value(octree.corner_count(), static_cast<float>(-folder.plan.spacing));
  for (const std::size_t t : tiles_of_corners(folder, tile)) {
    std::sort(asked[t].begin(), asked[t].end(), [](const Asked& a, const Asked& b) { return a.name < b.name; });
    const RecordFile<CornerValue> file(mesh_corners_path(folder.folder, t));
    std::vector<CornerValue> read;
    std::size_t next = 0;
    for (std::uint64_t at = 0; at < file.size(); at += kRecordsAtOnce) {
      read.clear();
      file.append(at, std::min(file.size(), at + kRecordsAtOnce), read);
      for (const CornerValue& corner : read) {
        while (next < asked[t].size() && asked[t][next].name < corner.whole_key()) ++next;
        if (next < asked[t].size() && asked[t][next].name == corner.whole_key()) value[asked[t][next].corner] = corner.value;
      }
    }
  }
  return value;
}

// Names of vertices, and whose they are.
class Names {
 public:
  Names(const MeshFolder& folder, const mesh::Octree& octree, const mesh::DualSurface& surface)
      : folder_(folder), octree_(octree), surface_(surface) {}

  [[nodiscard]] VertexKey key(std::size_t vertex) const {
    const std::size_t patches = surface_.patch_count();
    if (vertex >= patches) {
      const mesh::ArcMiddle& middle = surface_.midpoints[vertex - patches];
      const std::uint64_t a = leaf(surface_.patch_leaf[middle.patches[0]]);
      const std::uint64_t b = leaf(surface_.patch_leaf[middle.patches[1]]);
      return {{std::min(a, b), std::max(a, b), 1 + std::min(edge(middle.crossings[0]), edge(middle.crossings[1]))}};
    }
    std::uint64_t least = ~std::uint64_t{0};
    for (std::size_t k = surface_.patch_begin[vertex]; k < surface_.patch_begin[vertex + 1]; ++k)
      least = std::min(least, edge(surface_.patch_crossings[k]));
    return {{leaf(surface_.patch_leaf[vertex]), least, 0}};
  }

  [[nodiscard]] std::size_t owner_of_vertex(std::size_t vertex) const {
    const std::size_t patches = surface_.patch_count();
    if (vertex < patches) return folder_.owner(cell_at(low_of_leaf(surface_.patch_leaf[vertex]), folder_.cells.level));
    const auto& ends = surface_.midpoints[vertex - patches].crossings;
    return owner_of_edge(edge(ends[0]) < edge(ends[1]) ? ends[0] : ends[1]);
  }

  [[nodiscard]] std::size_t owner_of_edge(std::size_t crossing) const {
    return folder_.owner(cell_at(low_of_edge(crossing), folder_.cells.level));
  }

 private:
  using Grid = std::array<std::uint32_t, 3>;
  static constexpr int kBits = mesh::kMaxOctreeLevel;  // lower corners of leaves and of edges that cross are below the upper boundary

  static std::uint64_t pack(const Grid& g) { return std::uint64_t{g[2]} << (2 * kBits) | std::uint64_t{g[1]} << kBits | g[0]; }
  [[nodiscard]] Grid low_of_leaf(std::size_t leaf) const { return octree_.leaf(leaf).low; }
  [[nodiscard]] std::uint64_t leaf(std::size_t leaf) const { return pack(low_of_leaf(leaf)); }
  [[nodiscard]] Grid low_of_edge(std::size_t crossing) const {
    const Grid a = octree_.corner_grid(surface_.crossings[crossing].inside), b = octree_.corner_grid(surface_.crossings[crossing].outside);
    return {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])};
  }
  [[nodiscard]] std::uint64_t edge(std::size_t crossing) const {
    const Grid a = octree_.corner_grid(surface_.crossings[crossing].inside), b = octree_.corner_grid(surface_.crossings[crossing].outside);
    const std::uint64_t axis = a[0] != b[0] ? 0 : a[1] != b[1] ? 1 : 2;
    return pack(low_of_edge(crossing)) << 2U | axis;
  }

  const MeshFolder& folder_;
  const mesh::Octree& octree_;
  const mesh::DualSurface& surface_;
};

// What the file holds, but its vertices' places.
struct TilePatches {
  std::vector<std::pair<VertexKey, std::uint32_t>> own;  // by key, with the number in the surface
  std::vector<ForeignVertex> foreign;
  std::vector<std::uint8_t> sizes;  // of each polygon, and its diagonals
  std::vector<std::uint32_t> corners;
  PatchesHeader header;
};

TilePatches patches_of(const Names& names, const mesh::DualSurface& surface, std::size_t tile) {
  TilePatches out;
  const std::size_t count = surface.patch_count() + surface.midpoints.size();
  for (std::uint32_t v = 0; v < count; ++v) {
    if (names.owner_of_vertex(v) == tile) out.own.emplace_back(names.key(v), v);
  }
  std::sort(out.own.begin(), out.own.end());
  std::vector<std::uint32_t> number(count, 0);
  for (std::uint32_t i = 0; i < out.own.size(); ++i) number[out.own[i].second] = i;
  std::map<std::pair<std::size_t, VertexKey>, std::vector<std::size_t>> foreign;  // with the places among the corners
  for (std::size_t p = 0; p < surface.crossings.size(); ++p) {
    if (names.owner_of_edge(p) != tile) continue;
    const std::size_t size = surface.polygon_begin[p + 1] - surface.polygon_begin[p];
    const std::uint8_t safe = surface.safe_diagonals[p];
    out.sizes.push_back(static_cast<std::uint8_t>(size));
    out.sizes.push_back(safe);
    const bool in_two = size == 4 && safe != 0;
    out.header.centres += size == 3 || in_two ? 0 : 1;
    out.header.triangles += size == 3 ? 1 : in_two ? 2 : size;
    for (std::size_t k = surface.polygon_begin[p]; k < surface.polygon_begin[p + 1]; ++k) {
      const std::uint32_t v = surface.polygon_vertices[k];
      const std::size_t owner = names.owner_of_vertex(v);
      if (owner != tile) foreign[{owner, names.key(v)}].push_back(out.corners.size());
      out.corners.push_back(number[v]);
    }
  }
  for (const auto& [vertex, places] : foreign) {
    for (const std::size_t place : places) out.corners[place] = static_cast<std::uint32_t>(out.own.size() + out.foreign.size());
    out.foreign.push_back({vertex.second, vertex.first});
  }
  out.header.vertices = out.own.size();
  out.header.foreign = out.foreign.size();
  out.header.polygons = out.sizes.size() / 2;
  out.header.corners = out.corners.size();
  return out;
}

}  // namespace

void write_patches(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel) {
  const Surroundings around(folder, tile, cancel);
  const mesh::Octree& octree = *around.octree;
  const mesh::Prepared& prepared = around.prepared;
  const mesh::LocalFit local(prepared.points, *prepared.neighbours, prepared.near);
  const std::vector<float> value = read_corners(folder, around, tile);
  std::vector<std::uint8_t> inside(value.size());
  for (std::size_t c = 0; c < inside.size(); ++c) inside[c] = value[c] > 0 ? 1 : 0;
  const mesh::DualSurface surface = mesh::contour(octree, inside, joining_rule(folder, prepared, local), cancel);
  const Names names(folder, octree, surface);
  std::vector<std::uint8_t> wanted(surface.patch_count());
  for (std::size_t v = 0; v < wanted.size(); ++v) wanted[v] = names.owner_of_vertex(v) == tile ? 1 : 0;
  const mesh::PlacedVertices placed = mesh::place_vertices(octree, surface, value, local, cancel, wanted);

  const TilePatches patches = patches_of(names, surface, tile);
  std::vector<MeshVertex> vertices;
  for (const auto& [key, v] : patches.own) {
    MeshVertex vertex{key, placed.positions[v], {0, 0, 0}, 0};
    for (std::size_t a = 0; v < placed.normals.size() && a < 3; ++a) vertex.normal[a] = static_cast<float>(placed.normals[v][a]);
    vertices.push_back(vertex);
  }
  io::OutputFile out(mesh_patches_path(folder.folder, tile), cancel);
  out.write(&patches.header, sizeof patches.header);
  out.write_records(vertices);
  out.write_records(patches.foreign);
  out.write_records(patches.sizes);
  out.write_records(patches.corners);
  out.commit();
}

}  // namespace g3r::tiles
