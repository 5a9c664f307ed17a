// Scenes for the tests of the viewer: a torus beside a cube, as points with normals and as a mesh.
#pragma once

#include <g3r/view.h>

#include <cmath>

namespace g3r::testing {

/// Points on a torus of radii 1 and 0.4 around z, with outward normals, confidence and colours by position.
inline Scene torus_points(std::size_t count) {
  constexpr double kGolden = 0.6180339887498949;
  const double turn = 2 * std::acos(-1.0);
  Scene scene;
  scene.title = "torus";
  for (std::size_t i = 0; i < count; ++i) {
    const double u = turn * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    // Equidistributed pairs; the density along the tube is corrected by one Newton-like step of v + 0.4 sin v = v0.
    const double v0 = turn * std::fmod(static_cast<double>(i) * kGolden, 1.0);
    const double v = v0 - 0.4 * std::sin(v0);
    const Vec3 n = {std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)};
    scene.points.push_back({std::cos(u) + 0.4 * n[0], std::sin(u) + 0.4 * n[1], 0.4 * n[2]});
    scene.normals.push_back(n);
    scene.confidence.push_back(static_cast<float>(0.5 + 0.5 * std::cos(u)));
    scene.colors.push_back({static_cast<std::uint8_t>(127 + 127 * n[0]), static_cast<std::uint8_t>(127 + 127 * n[1]),
                            static_cast<std::uint8_t>(127 + 127 * n[2])});
  }
  return scene;
}

/// The same torus as a closed mesh of 2 * rings * sides triangles, counter-clockwise seen from outside.
inline Mesh torus_mesh(std::uint32_t rings, std::uint32_t sides) {
  const double turn = 2 * std::acos(-1.0);
  Mesh mesh;
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double u = turn * i / rings, v = turn * j / sides;
      mesh.vertices.push_back({(1 + 0.4 * std::cos(v)) * std::cos(u), (1 + 0.4 * std::cos(v)) * std::sin(u), 0.4 * std::sin(v)});
      const std::uint32_t a = i * sides + j, b = ((i + 1) % rings) * sides + j;
      const std::uint32_t c = ((i + 1) % rings) * sides + (j + 1) % sides, d = i * sides + (j + 1) % sides;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

/// Adds the closed cube [centre - half, centre + half] to a mesh.
inline void add_cube(Mesh& mesh, const Vec3& centre, double half) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        {centre[0] + ((i & 1) != 0 ? half : -half), centre[1] + ((i & 2) != 0 ? half : -half), centre[2] + ((i & 4) != 0 ? half : -half)});
  }
  const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({first + q[0], first + q[1], first + q[2]});
    mesh.triangles.push_back({first + q[0], first + q[2], first + q[3]});
  }
}

}  // namespace g3r::testing
