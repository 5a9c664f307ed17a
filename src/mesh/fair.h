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

/// Makes the surface fair around the marked points: of the vertices to which one of them is the nearest point. The others stay, and so do
/// those around which triangles would intersect that did not before (up to three times tried without them; then connected regions with such
/// triangles stay). Without marked points nothing happens. Connectivity stays. The same result for any number of threads. O(V log N), at
/// most four times 900 products with a sparse matrix of V rows, and five searches for crossings. Throws Cancelled.
void make_fair(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::uint8_t>& in_lines,
               const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
