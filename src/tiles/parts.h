// The connected parts of the surface within each tile (pass 4), what holds them, and which of the components that they make stay.
#pragma once

#include "io/random_file.h"
#include "mesh/component_support.h"
#include "tiles/mesh_plan.h"

#include <g3r/mesh.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

/// What a tile knows of one of its parts.
struct Part {
  mesh::Support support;        ///< in the unit frame; of its own triangles
  std::uint64_t vertices = 0;   ///< of the tile that are in it
  std::uint64_t centres = 0;    ///< added in the middle of its polygons
  std::uint64_t triangles = 0;  ///< of the tile
};
static_assert(sizeof(Part) == 72);

/// Where a vertex of another tile is in that tile, and the part that it is in here.
struct ForeignPart {
  std::uint64_t vertex;
  std::uint32_t tile;
  std::uint32_t part;
};
static_assert(sizeof(ForeignPart) == 16);

/// A vertex that is elsewhere than the patches say, for triangles not to cross.
struct MovedVertex {
  std::uint64_t vertex;  ///< an own one, or after them one of those in the middle of polygons
  Vec3 position;
};
static_assert(sizeof(MovedVertex) == 32);

/// At the head of a file of parts: then come the parts, the moved vertices, ascending, the foreign vertices in the order of the patches,
/// and the part of every own vertex.
struct PartsHeader {
  std::uint64_t parts = 0;
  std::uint64_t moved = 0;
  std::uint64_t foreign = 0;
  std::uint64_t vertices = 0;
  std::uint64_t strays = 0;  ///< among its own points
};

/// A file of parts, piece by piece. All members throw IoError, InvalidInput where it is damaged.
class PartsFile {
 public:
  PartsFile(const MeshFolder& folder, std::size_t tile);

  [[nodiscard]] const PartsHeader& header() const { return header_; }
  [[nodiscard]] std::vector<Part> parts() const;
  [[nodiscard]] std::vector<MovedVertex> moved() const;
  [[nodiscard]] std::vector<ForeignPart> foreign() const;
  /// Of own vertices [begin, end).
  [[nodiscard]] std::vector<std::uint32_t> parts_of(std::uint64_t begin, std::uint64_t end) const;

  [[noreturn]] void fail() const;

 private:
  io::RandomFile file_;
  PartsHeader header_;
  std::uint64_t movable_ = 0;  // vertices: own and in the middle of polygons
};

/// The components that all tiles' parts make together: parts of two tiles are one where they share a vertex. Holds a few dozen bytes for
/// every part.
class KeptParts {
 public:
  /// Takes those that mesh::kept_components() keeps; what goes is added to `dropped`, areas in the unit frame, and so are strays.
  KeptParts(const MeshFolder& folder, const MeshOptions& options, Dropped& dropped);

  [[nodiscard]] bool keeps(std::size_t tile, std::uint32_t part) const { return keep_[first_[tile] + part] != 0; }
  /// Of components that stay.
  [[nodiscard]] std::size_t components() const { return components_; }
  /// Vertices, centres and triangles of the tile that stay; its support is left empty.
  [[nodiscard]] const Part& counts(std::size_t tile) const { return counts_[tile]; }

 private:
  std::vector<std::size_t> first_;  // part of each tile
  std::vector<std::uint8_t> keep_;
  std::vector<Part> counts_;
  std::size_t components_ = 0;
};

}  // namespace g3r::tiles
