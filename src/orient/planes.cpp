#include "orient/planes.h"

#include "cloud/exact_plane.h"
#include "cpu/parallel.h"
#include "vector.h"

#include <cstddef>

namespace g3r {

void fit_planes(const std::vector<Vec3>& points, const Neighbours& neighbours, const std::vector<double>& spacing,
                std::vector<std::uint8_t>& proven, std::vector<Vec3>& normals) {
  constexpr std::size_t kBlock = 1024;  // points per parallel block
  parallel::for_blocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) {
      if (proven[i] != 0) continue;
      neighbours.nearest(points[i], kPlaneNeighbours, index, squared);
      const ExactPlane plane = find_exact_plane(points, index, spacing[i], &normals[i]);
      if (plane.points.empty()) continue;
      proven[i] = 1;
      normals[i] = vector::scale(plane.normal, vector::dot(plane.normal, normals[i]) < 0 ? -1 : 1);
    }
  });
}

}  // namespace g3r
