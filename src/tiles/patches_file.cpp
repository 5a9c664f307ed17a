#include "tiles/patches_file.h"

#include <g3r/io.h>

#include <algorithm>

namespace g3r::tiles {

PatchesFile::PatchesFile(const std::string& folder, std::size_t tile) : file_(mesh_patches_path(folder, tile)) {
  if (file_.size() < sizeof header_) fail();
  file_.read(0, &header_, sizeof header_);
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40U;  // records; sums below do not overflow
  for (const std::uint64_t count : {header_.vertices, header_.foreign, header_.polygons, header_.corners}) {
    if (count > kMost) fail();
  }
  if (file_.size() != corners_at() + header_.corners * sizeof(std::uint32_t)) fail();
}

void PatchesFile::read_polygons(mesh::DualSurface& surface) const {
  std::vector<std::uint8_t> sizes;
  append(polygons_at(), 2 * header_.polygons, sizes);
  append(corners_at(), header_.corners, surface.polygon_vertices);
  surface.polygon_begin.assign(1, 0);
  for (std::size_t p = 0; p < header_.polygons; ++p) {
    if (sizes[2 * p] < 3 || (sizes[2 * p + 1] != 0 && sizes[2 * p] != 4)) fail();
    surface.polygon_begin.push_back(surface.polygon_begin.back() + sizes[2 * p]);
    surface.safe_diagonals.push_back(sizes[2 * p + 1]);
  }
  surface.crossings.resize(header_.polygons);
  const std::uint64_t count = header_.vertices + header_.foreign;
  const auto is_number = [&](std::uint32_t v) { return v < count; };
  if (surface.polygon_begin.back() != header_.corners ||
      !std::all_of(surface.polygon_vertices.begin(), surface.polygon_vertices.end(), is_number)) {
    fail();
  }
}

std::vector<std::size_t> PatchesFile::foreign_tiles() const {
  std::vector<ForeignVertex> foreign;
  append_foreign(foreign);
  std::vector<std::size_t> tiles;
  for (const ForeignVertex& vertex : foreign) {
    if (tiles.empty() || tiles.back() != vertex.tile) tiles.push_back(static_cast<std::size_t>(vertex.tile));
  }
  return tiles;
}

void PatchesFile::fail() const { throw InvalidInput(escape_text(file_.path()) + ": damaged; remove it, and mesh again"); }

TileSurface read_surface(const MeshFolder& folder, std::size_t tile) {
  const PatchesFile file(folder.folder, tile);
  std::vector<MeshVertex> vertices;
  std::vector<ForeignVertex> foreign;
  file.append_vertices(0, file.header().vertices, vertices);
  file.append_foreign(foreign);
  TileSurface out;
  out.own = vertices.size();
  for (std::size_t f = 0; f < foreign.size();) {
    const std::uint64_t from = foreign[f].tile;
    if (from >= folder.tiles()) file.fail();
    const PatchesFile there(folder.folder, static_cast<std::size_t>(from));
    std::vector<MeshVertex> read;
    for (std::uint64_t at = 0; at < there.header().vertices; at += kRecordsAtOnce) {
      read.clear();
      there.append_vertices(at, std::min(there.header().vertices, at + kRecordsAtOnce), read);
      for (std::size_t k = 0; k < read.size(); ++k) {
        if (f == foreign.size() || foreign[f].tile != from || read[k].key != foreign[f].key) continue;
        vertices.push_back(read[k]);
        out.foreign.push_back({static_cast<std::size_t>(from), at + k});
        ++f;
      }
    }
    if (f < foreign.size() && foreign[f].tile == from) there.fail();
  }
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  for (const MeshVertex& v : vertices) {
    positions.push_back(v.position);
    normals.push_back({v.normal[0], v.normal[1], v.normal[2]});
  }
  mesh::DualSurface surface;
  file.read_polygons(surface);
  out.mesh = mesh::triangulate(surface, std::move(positions), normals);
  if (out.mesh.triangles.size() != file.header().triangles || out.mesh.vertices.size() != vertices.size() + file.header().centres) {
    file.fail();
  }
  return out;
}

}  // namespace g3r::tiles
