// A mesh and the points it was made from: what the points carry brought onto the mesh, and parts without points cut off.
#pragma once

#include <g3r/error.h>
#include <g3r/export.h>
#include <g3r/mesh.h>
#include <g3r/points.h>

#include <array>
#include <cstdint>
#include <vector>

namespace G3R_PUBLIC g3r {

/// The colour of the nearest point for every vertex. `colors`: one per point; points that are not finite give nothing.
/// O((N + V) log N). Throws InvalidInput: sizes that differ, no finite point.
[[nodiscard]] std::vector<std::array<std::uint8_t, 3>> carry_colors(const Mesh& mesh, const PointsView& points,
                                                                    const std::vector<std::array<std::uint8_t, 3>>& colors);

/// The confidence of the nearest point for every vertex; like carry_colors().
[[nodiscard]] std::vector<float> carry_confidence(const Mesh& mesh, const PointsView& points, const std::vector<float>& confidence);

/// The mesh without the triangles that have a vertex farther than `distance` from every point, and without vertices that no triangle
/// uses any more; for open scans, which a closed mesh bridges. Colours and confidence stay with their vertices. The order is kept.
/// Throws InvalidInput: a distance that is not above 0, no finite point, a triangle that names no vertex, nothing left.
[[nodiscard]] Mesh trim_mesh(const Mesh& mesh, const PointsView& points, double distance);

}  // namespace g3r
