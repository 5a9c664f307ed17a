// Fewer triangles: quadric edge collapse (Garland, Heckbert, SIGGRAPH 1997) by meshoptimizer. The only mesher file that names it is
// simplify.cpp.
#pragma once

#include <g3r/mesh.h>

#include <cstddef>

namespace g3r::mesh {

/// Simplifies to `faces` triangles or a few less; to more, or not at all, where fewer would make the mesh non-manifold, open it, or change
/// the number of its components or its genus. Vertices stay where they are. Attributes are kept. O(F log F).
void simplify(Mesh& mesh, std::size_t faces);

}  // namespace g3r::mesh
