// Screened Poisson surface reconstruction: oriented points -> triangle mesh.
//
// Source: Kazhdan, Hoppe, "Screened Poisson surface reconstruction", ACM Trans. Graph. 32(3), 2013, in the authors' code as shipped with
// Open3D. This is the only place that knows Open3D. Without it (G3R_WITH_OPEN3D=OFF) screened_poisson() throws Unavailable.
#pragma once

#include "cloud/canonical_cloud.h"

#include <g3r/mesh.h>

#include <vector>

namespace g3r {

/// The side of the octree's cube over that of the box of the points: the margin of the method's authors, and of the unit frame. Without one
/// the surface would leave the cube.
inline constexpr double kPoissonCube = 2 / kBoxSide;

/// The largest depth that is chosen without being asked for: more costs minutes and gigabytes. The paper preset takes it, as the
/// comparisons in docs/evidence/meshes.md do.
inline constexpr int kMostAutomaticDepth = 10;

/// Octree depth whose cells are about as wide as the points are apart.
/// `spacing`: square root of area per point, > 0; `box_side`: longest side of the bounding box, same unit. Result in 4..10.
[[nodiscard]] int automatic_depth(double spacing, double box_side);

/// Whether this build has screened_poisson().
[[nodiscard]] bool screened_poisson_available();
/// Throws what screened_poisson() would throw in a build without Open3D: before a long solve, not after it.
void require_screened_poisson();

/// Meshes N points with their N outward normals of any length (the length has no influence). Triangles face the way the normals do, so the
/// signed volume is positive. The mesh is manifold, and closed unless the surface leaves the cube around the points (an open surface does).
/// Every vertex is used by a triangle. Where points are dense the cells of the octree are 1.1 * (longest side of the box) / 2^depth wide.
///
/// Coordinates are centred and scaled in double first; vertices come back with single precision relative to the box. Runs on one thread,
/// because with more the result differs from run to run; the same input gives the same bytes. Concurrent calls wait for each other.
/// It cannot be cancelled while it runs. 50,000 points take about 2.5 s and 130 MB at depth 8, 5 s and 210 MB at depth 10, 15 s at
/// depth 11.
///
/// Throws InvalidInput: sizes that differ, fewer than 4 points, all points at one place, a coordinate or normal that is not finite,
/// a zero normal, a depth outside 4..12, or no surface was found.
[[nodiscard]] Mesh screened_poisson(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, int depth);

}  // namespace g3r
