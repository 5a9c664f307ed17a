// Manifold dual contouring of a sign pattern on an octree: which vertices there are and how they are joined, no positions yet.
//
// Ju, Losasso, Schaefer, Warren, "Dual contouring of Hermite data", SIGGRAPH 2002 (one polygon per crossing edge);
// Schaefer, Ju, Warren, "Manifold dual contouring", TVCG 2007 (one vertex per patch). docs/math.md proves that the result is a
// closed 2-manifold for every octree and every sign pattern whose boundary corners are outside.
#pragma once

#include "mesh/field_octree.h"

#include <g3r/mesh.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace g3r::mesh {

/// An octree edge whose ends lie on different sides.
struct Crossing {
  std::uint32_t inside = 0;   ///< corner
  std::uint32_t outside = 0;  ///< corner
};

/// A vertex in the middle of an arc: of the line across a face of the octree along which two patches meet.
struct ArcMiddle {
  std::array<std::uint32_t, 2> patches{};
  std::array<std::uint32_t, 2> crossings{};  ///< at the ends of the arc
};

/// The surface as a polygon mesh. Vertices 0..patches-1 are patches, each within one leaf; the rest subdivide edges that would coincide.
struct DualSurface {
  std::vector<Crossing> crossings;              ///< one per polygon
  std::vector<std::uint32_t> patch_leaf;        ///< leaf that holds each patch
  std::vector<std::uint32_t> patch_begin;       ///< patches + 1 offsets into patch_crossings
  std::vector<std::uint32_t> patch_crossings;   ///< crossings on the rim of each patch
  std::vector<ArcMiddle> midpoints;             ///< for each further vertex
  std::vector<std::uint32_t> polygon_begin;     ///< crossings + 1 offsets into polygon_vertices
  std::vector<std::uint32_t> polygon_vertices;  ///< counter-clockwise seen from outside
  std::vector<std::uint8_t> safe_diagonals;     ///< per polygon of four: bit 0: diagonal 0-2, bit 1: diagonal 1-3 may be used

  [[nodiscard]] std::size_t patch_count() const { return patch_leaf.size(); }
};

/// Tells, for points at the centre of octree faces whose corner signs can be joined in two ways, whether they are inside.
using InsideTest = std::function<std::vector<std::uint8_t>(const std::vector<Vec3>&)>;

/// `inside`: one byte per corner, 0 for all corners on the boundary of the octree. O(leaves + crossings log crossings).
/// Throws Cancelled.
[[nodiscard]] DualSurface contour(const Octree& octree, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside,
                                  const std::atomic<bool>* cancel = nullptr);
/// The same without midpoints and polygons.
[[nodiscard]] DualSurface patches_of(const Octree& octree, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside,
                                     const std::atomic<bool>* cancel = nullptr);

using LeafTest = std::function<bool(std::uint32_t)>;  ///< whether a leaf is one of some

/// Patches without a surface around them.
struct Patches {
  std::vector<std::uint32_t> leaf;   ///< that holds each patch
  std::vector<std::uint32_t> begin;  ///< patches + 1 offsets into rim
  std::vector<std::uint32_t> rim;    ///< edges that cross on the rim of each patch
};

/// The patches of the surface in the leaves for which wanted(leaf) alone. `chosen`: of `edges`, at least those around such leaves; in the
/// order that the edges of rims are to have. O(chosen log chosen).
[[nodiscard]] Patches patches_in(const Octree& octree, const std::vector<MinimalEdge>& edges, const std::vector<std::uint32_t>& chosen,
                                 const LeafTest& wanted, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside);

/// Cuts the polygons into triangles; `positions` has one entry per vertex of the surface, `normals` (may be empty) one per patch.
/// Quadrilaterals are cut along the diagonal that bends less against the normals; other polygons get a vertex at their centre.
[[nodiscard]] Mesh triangulate(const DualSurface& surface, std::vector<Vec3> positions, const std::vector<Vec3>& normals);

}  // namespace g3r::mesh
