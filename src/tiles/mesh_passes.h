// The four passes over the tiles of a mesh. Each writes what its tile alone decides, and reads what others have decided, so that all agree
// on every point, corner and vertex, whatever they see of their surroundings.
#pragma once

#include "mesh/field_contour.h"
#include "mesh/field_octree.h"
#include "mesh/field_points.h"
#include "tiles/mesh_plan.h"
#include "tiles/mesh_records.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace g3r::tiles {

/// Pass 1: its points as the fits see them, and their area vectors added up for those who are far away.
void write_points(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel);
/// Pass 2, after pass 1 of all tiles: the sides of its corners of the octree.
void write_corners(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel);
/// Pass 3, after pass 2 of tiles_of_corners() of it: its vertices, and the polygons around its edges.
void write_patches(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel);
/// Pass 4, after pass 3 of it and of the tiles whose vertices it has, and pass 1 of tiles_around() it: the connected parts of its
/// triangles, and what holds them.
void write_parts(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel);

/// The tiles with points at most kAround cells away, itself included, ascending.
[[nodiscard]] std::vector<std::size_t> tiles_around(const MeshFolder& folder, std::size_t tile);

/// The tiles, itself included, that have corners of leaves which touch a place of the tile: far from all points these are as large as the
/// gap, and their corners belong to tiles whose points are elsewhere. Ascending.
[[nodiscard]] std::vector<std::size_t> tiles_of_corners(const MeshFolder& folder, std::size_t tile);

/// Calls take(tile, point) for the points of the cells of ring 0, in order, without repeated places and strays.
void for_points_around(const MeshFolder& folder, const std::vector<std::uint8_t>& rings,
                       const std::function<void(std::size_t, const MeshPoint&)>& take);

/// The points around a tile, and the octree around it: as in every other tile where its own places are and next to them.
struct Surroundings {
  Surroundings(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel);
  Surroundings(const Surroundings&) = delete;  // the neighbours refer to the points
  Surroundings& operator=(const Surroundings&) = delete;

  Region region;
  std::vector<std::uint8_t> rings;  ///< of all cells
  mesh::Prepared prepared;
  std::vector<std::uint32_t> own;  ///< numbers of its own points
  std::unique_ptr<const mesh::Octree> octree;
};

/// Of places where signs can be joined in two ways: by the fit where all that it is made of is less than a cell away, which every tile that
/// looks there sees too; elsewhere inside is cut off.
[[nodiscard]] mesh::InsideTest joining_rule(const MeshFolder& folder, const mesh::Prepared& prepared, const mesh::LocalFit& local);

/// Name of a corner, for all tiles.
[[nodiscard]] std::uint64_t corner_name(const std::array<std::uint32_t, 3>& grid);

}  // namespace g3r::tiles
