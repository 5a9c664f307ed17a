// Fair surface where points lie in lines: there the points do not say how the surface bends across them.
//
// The mesh keeps its connectivity, and its vertices go where the sum of the squared Laplacians and of the squared distances of the points
// from it is least: Sorkine, Cohen-Or, "Least-squares meshes", SMI 2004.
#pragma once

#include <g3r/mesh.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// The share of points along curves from which a place, or a cloud, is sampled in lines: none of a random sample are, where lines cross
/// few, and of wireframes a quarter and more.
inline constexpr double kInLines = 0.25;

/// Marks (1) the points that lie along a curve with their 8 nearest. `near`: Neighbours::of_all(k) of the points, k >= 9. O(N).
[[nodiscard]] std::vector<std::uint8_t> points_along_curves(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near);

/// Marks (1) the points of which a quarter of the 16 nearest lie along a curve with their 8 nearest; if that are half of all, all are.
/// `near`: Neighbours::of_all(k) of the points, k >= 16. Random samples of surfaces, their creases and rims are not marked. O(N).
[[nodiscard]] std::vector<std::uint8_t> points_in_lines(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near);

/// Makes the surface fair around the marked points: of the vertices to which one of them is the nearest point. The others stay, and so do
/// those around which triangles would intersect that did not before (up to three times tried without them; then connected regions with such
/// triangles stay). Without marked points nothing happens. Connectivity stays. The same result for any number of threads. O(V log N), at
/// most four times 900 products with a sparse matrix of V rows, and five searches for crossings. Throws Cancelled.
void make_fair(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::uint8_t>& in_lines,
               const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
