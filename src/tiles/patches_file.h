// What pass 3 leaves of a tile: its patches, and the triangles that they make.
#pragma once

#include "io/random_file.h"
#include "mesh/field_contour.h"
#include "tiles/mesh_plan.h"
#include "tiles/mesh_records.h"

#include <g3r/mesh.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

/// A file of patches, piece by piece. All members throw IoError, InvalidInput where it is damaged.
class PatchesFile {
 public:
  PatchesFile(const std::string& folder, std::size_t tile);

  [[nodiscard]] const PatchesHeader& header() const { return header_; }
  void append_vertices(std::uint64_t begin, std::uint64_t end, std::vector<MeshVertex>& out) const {
    append(sizeof header_ + begin * sizeof(MeshVertex), end - begin, out);
  }
  void append_foreign(std::vector<ForeignVertex>& out) const { append(foreign_at(), header_.foreign, out); }
  /// The tiles whose vertices its polygons have, ascending.
  [[nodiscard]] std::vector<std::size_t> foreign_tiles() const;
  /// Checked: every corner is one of its vertices, and the polygons use all corners.
  void read_polygons(mesh::DualSurface& surface) const;

  [[noreturn]] void fail() const;

 private:
  [[nodiscard]] std::uint64_t foreign_at() const { return sizeof header_ + header_.vertices * sizeof(MeshVertex); }
  [[nodiscard]] std::uint64_t polygons_at() const { return foreign_at() + header_.foreign * sizeof(ForeignVertex); }
  [[nodiscard]] std::uint64_t corners_at() const { return polygons_at() + 2 * header_.polygons; }
  template <class T>
  void append(std::uint64_t at, std::uint64_t count, std::vector<T>& out) const {
    const std::size_t before = out.size();
    out.resize(before + static_cast<std::size_t>(count));
    file_.read(at, out.data() + before, static_cast<std::size_t>(count) * sizeof(T));
  }

  io::RandomFile file_;
  PatchesHeader header_;
};

/// The triangles of one tile, in the unit frame. Its vertices are the own ones, the foreign ones, and those in the middle of polygons.
struct TileSurface {
  struct Place {
    std::size_t tile;
    std::uint64_t vertex;  ///< among those of the tile
  };
  Mesh mesh;
  std::size_t own = 0;
  std::vector<Place> foreign;
};

/// Throws IoError, InvalidInput where a file is damaged.
[[nodiscard]] TileSurface read_surface(const MeshFolder& folder, std::size_t tile);

}  // namespace g3r::tiles
