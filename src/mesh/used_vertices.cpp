#include "mesh/used_vertices.h"

#include <g3r/error.h>

#include <string>

namespace g3r {

vector::Box box_of_used_vertices(const Mesh& mesh) {
  vector::Box box;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const std::uint32_t v : mesh.triangles[f]) {
      if (v >= mesh.vertices.size()) {
        throw InvalidInput("triangle " + std::to_string(f) + " names vertex " + std::to_string(v) + ", but the mesh has " +
                           std::to_string(mesh.vertices.size()) + " vertices");
      }
      const Vec3& p = mesh.vertices[v];
      for (const double x : p) {
        if (!(std::fabs(x) <= kLargestCoordinate)) {
          throw InvalidInput("vertex " + std::to_string(v) + " of triangle " + std::to_string(f) +
                             " has a coordinate that is not finite or beyond 1e50");
        }
      }
      box.extend(p);
    }
  }
  return box;
}

}  // namespace g3r
