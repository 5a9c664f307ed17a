// What the files of a meshed work folder hold, and how they are read.
#pragma once

#include "base/pair_key.h"
#include "tiles/mesh_plan.h"
#include "tiles/records.h"

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace g3r::tiles {

inline constexpr float kStray = -1;

/// A point as the fits see it, in the unit frame, in the order of the sorted points.
struct MeshPoint {
  Vec3 position;
  std::array<float, 3> normal;
  float spacing;  ///< 0: the same place as the point before it, which stands for it, or a stray
  float size;     ///< of what is to be seen there
  float room;     ///< kStray of a stray; the disc around it may be so wide: then it stays within one cell of its own
};
static_assert(sizeof(MeshPoint) == 48);

/// The area vectors of the points in a cell, added up.
struct FarNode {
  std::uint64_t key;  ///< 1 before the bits of the cell's code: ascending keys are levels, coarse to fine, each in Morton order
  Vec3 place;         ///< weighed by area
  std::array<float, 3> eta;
  float area;
};
static_assert(sizeof(FarNode) == 48);

/// The side of a corner of the octree, which only its own tile computes.
struct CornerValue {
  std::array<std::uint32_t, 2> key;  ///< low, high half
  float value;
  [[nodiscard]] std::uint64_t whole_key() const { return pair_key(key[1], key[0]); }
};
static_assert(sizeof(CornerValue) == 12);

/// Names a vertex of the dual surface in whatever tile it is met. Of a patch: its leaf, the least edge on its rim, 0. Of the middle of an
/// arc: the lesser and the greater leaf, 1 + the lesser edge.
struct VertexKey {
  std::array<std::uint64_t, 3> part;
  bool operator==(const VertexKey&) const = default;
  bool operator<(const VertexKey& other) const { return part < other.part; }
};

struct MeshVertex {
  VertexKey key;
  Vec3 position;
  std::array<float, 3> normal;
  std::uint32_t reserved;
};
static_assert(sizeof(MeshVertex) == 64);

/// A vertex of another tile that polygons of this one have.
struct ForeignVertex {
  VertexKey key;
  std::uint64_t tile;
};
static_assert(sizeof(ForeignVertex) == 32);

/// At the head of a file of patches: then come its vertices by key, the foreign ones by tile and key, for each polygon its size and
/// diagonals (a byte each), and the corners of all polygons, numbers of own vertices, then of foreign ones.
struct PatchesHeader {
  std::uint64_t vertices = 0;
  std::uint64_t foreign = 0;
  std::uint64_t polygons = 0;
  std::uint64_t corners = 0;
  std::uint64_t centres = 0;    ///< vertices that are added in the middle of polygons
  std::uint64_t triangles = 0;  ///< that the polygons are cut into
};

[[nodiscard]] std::string mesh_plan_path(const std::string& folder);
[[nodiscard]] std::string mesh_points_path(const std::string& folder, std::size_t tile);
[[nodiscard]] std::string mesh_far_path(const std::string& folder, std::size_t tile);
[[nodiscard]] std::string mesh_corners_path(const std::string& folder, std::size_t tile);
[[nodiscard]] std::string mesh_patches_path(const std::string& folder, std::size_t tile);
[[nodiscard]] std::string mesh_parts_path(const std::string& folder, std::size_t tile);

/// Points with the normals that their tiles found, in the unit frame.
struct RawPoints {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
};

/// Those of the cells for which wanted(cell), in order, without repeated places.
/// Throws IoError, InvalidInput.
[[nodiscard]] RawPoints read_raw_points(const std::string& folder, const Manifest& manifest, const Cells& cells,
                                        const std::function<bool(std::size_t)>& wanted);

/// Calls take(first, last) for the runs of consecutive cells for which wanted(cell), cut where bound(cell) changes.
void for_runs(std::size_t cells, const std::function<bool(std::size_t)>& wanted, const std::function<std::size_t(std::size_t)>& bound,
              const std::function<void(std::size_t, std::size_t)>& take);

}  // namespace g3r::tiles
