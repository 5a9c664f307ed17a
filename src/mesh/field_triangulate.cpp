// Polygons of the dual surface -> triangles.
#include "base/vector.h"
#include "mesh/field_contour.h"
#include "mesh/triangle.h"

#include <algorithm>
#include <cmath>

namespace g3r::mesh {
namespace {

// Cosine between a triangle and the mean of the normals at its corners, the worse of two triangles; falls back on the angle between them.
class DiagonalQuality {
 public:
  DiagonalQuality(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) : positions_(positions), normals_(normals) {}

  double operator()(const std::array<std::uint32_t, 3>& s, const std::array<std::uint32_t, 3>& t) const {
    const Vec3 a = unit_normal(s), b = unit_normal(t);
    if (normals_.empty()) return vector::dot(a, b);
    return std::min(agreement(a, s), agreement(b, t)) + 1e-3 * vector::dot(a, b);
  }

 private:
  Vec3 unit_normal(const std::array<std::uint32_t, 3>& t) const {
    Vec3 n = twice_area_vector(positions_, t);
    const double length = std::sqrt(vector::dot(n, n));
    for (double& c : n) c = length > 0 ? c / length : 0;
    return n;
  }
  double agreement(const Vec3& n, const std::array<std::uint32_t, 3>& t) const {
    double worst = 1;
    for (const std::uint32_t v : t) worst = std::min(worst, vector::dot(n, normals_[v]));
    return worst;
  }
  const std::vector<Vec3>& positions_;
  const std::vector<Vec3>& normals_;
};

}  // namespace

Mesh triangulate(const DualSurface& surface, std::vector<Vec3> positions, const std::vector<Vec3>& normals) {
  Mesh mesh;
  mesh.triangles.reserve(surface.crossings.size() * 2);
  const std::size_t sized = positions.size();
  const DiagonalQuality quality(positions, normals);
  std::vector<Vec3> centres;
  for (std::size_t p = 0; p < surface.crossings.size(); ++p) {
    const std::uint32_t* v = surface.polygon_vertices.data() + surface.polygon_begin[p];
    const std::size_t n = surface.polygon_begin[p + 1] - surface.polygon_begin[p];
    if (n == 3) {
      mesh.triangles.push_back({v[0], v[1], v[2]});
    } else if (surface.safe_diagonals[p] != 0) {
      const std::array<std::uint32_t, 3> s{v[0], v[1], v[2]}, t{v[0], v[2], v[3]}, x{v[1], v[2], v[3]}, y{v[1], v[3], v[0]};
      const bool first = surface.safe_diagonals[p] == 1 || (surface.safe_diagonals[p] == 3 && quality(s, t) >= quality(x, y));
      mesh.triangles.push_back(first ? s : x);
      mesh.triangles.push_back(first ? t : y);
    } else {
      Vec3 centre{0, 0, 0};
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t a = 0; a < 3; ++a) centre[a] += positions[v[i]][a] / static_cast<double>(n);
      }
      const auto c = static_cast<std::uint32_t>(sized + centres.size());
      centres.push_back(centre);
      for (std::size_t i = 0; i < n; ++i) mesh.triangles.push_back({v[i], v[(i + 1) % n], c});
    }
  }
  mesh.vertices = std::move(positions);
  mesh.vertices.insert(mesh.vertices.end(), centres.begin(), centres.end());
  return mesh;
}

}  // namespace g3r::mesh
