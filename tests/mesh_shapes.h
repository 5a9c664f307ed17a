// Triangle meshes made for tests. All are oriented outward.
#pragma once

#include <g3r/mesh.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace g3r::shapes {

inline constexpr double kPi = 3.14159265358979323846;

/// Corners (0,0,0), (1,0,0), (0,1,0), (0,0,1): volume 1/6.
inline Mesh tetrahedron() {
  Mesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  m.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return m;
}

/// [0, 1]^3.
inline Mesh cube() {
  Mesh m;
  for (int i = 0; i < 8; ++i) m.vertices.push_back({double(i & 1), double((i >> 1) & 1), double((i >> 2) & 1)});
  const std::array<std::array<std::uint32_t, 4>, 6> quads = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& q : quads) {
    m.triangles.push_back({q[0], q[1], q[2]});
    m.triangles.push_back({q[0], q[2], q[3]});
  }
  return m;
}

/// Torus around the z axis, `around` x `across` quads.
inline Mesh torus(double major, double minor, std::uint32_t around, std::uint32_t across) {
  Mesh m;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2 * kPi * i / around, v = 2 * kPi * j / across;
      m.vertices.push_back({(major + minor * std::cos(v)) * std::cos(u), (major + minor * std::cos(v)) * std::sin(u), minor * std::sin(v)});
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return (a % around) * across + b % across; };
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

/// Sphere about the origin: `slices` / 2 rings of `slices` quads, and fans at the poles.
inline Mesh sphere(double radius, std::uint32_t slices) {
  Mesh m;
  const std::uint32_t rings = slices / 2;
  m.vertices.push_back({0, 0, radius});
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t j = 0; j < slices; ++j) {
      const double t = kPi * i / rings, u = 2 * kPi * j / slices;
      m.vertices.push_back({radius * std::sin(t) * std::cos(u), radius * std::sin(t) * std::sin(u), radius * std::cos(t)});
    }
  }
  m.vertices.push_back({0, 0, -radius});
  const auto at = [&](std::uint32_t ring, std::uint32_t j) { return 1 + (ring - 1) * slices + j % slices; };
  const auto south = static_cast<std::uint32_t>(m.vertices.size() - 1);
  for (std::uint32_t j = 0; j < slices; ++j) {
    m.triangles.push_back({0, at(1, j), at(1, j + 1)});
    m.triangles.push_back({south, at(rings - 1, j + 1), at(rings - 1, j)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

/// Square [-half, half]^2 at height z, facing up, n x n quads: an open surface.
inline Mesh square(double half, double z, std::uint32_t n) {
  Mesh m;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) m.vertices.push_back({half * (2.0 * i / n - 1), half * (2.0 * j / n - 1), z});
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i * (n + 1) + j; };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

inline Mesh moved(Mesh m, const Vec3& by, double scale = 1) {
  for (Vec3& p : m.vertices) {
    for (std::size_t k = 0; k < 3; ++k) p[k] = p[k] * scale + by[k];
  }
  return m;
}

inline Mesh inverted(Mesh m) {
  for (auto& t : m.triangles) std::swap(t[1], t[2]);
  return m;
}

inline Mesh united(Mesh a, const Mesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

}  // namespace g3r::shapes
