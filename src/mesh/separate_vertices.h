// No two vertices at one place, also where places are kept in single precision.
#pragma once

#include <g3r/mesh.h>

#include <cstddef>

namespace g3r::mesh {

/// Moves vertices that have the place of another one, as it is or rounded to float about the origin (STL, many readers) or about the centre
/// of the box (glTF), along their normals to a free place: 2, 4, 8, ... steps of float away, at most kAtOnePlace of their shortest edge;
/// where none is free the vertex stays. Programs that weld equal positions then see the mesh as its indices have it. So far from the origin
/// that the steps of float show (suits_float), rounding about it is left alone. Which vertices: all but the first of those at one place.
/// Returns how many moved. O(V log V + F), 40 bytes per vertex. The same for any number of threads.
std::size_t separate_vertices(Mesh& mesh);

}  // namespace g3r::mesh
