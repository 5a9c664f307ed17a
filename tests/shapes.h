// Generated point sets with known normals, areas and topology for the tests.
#pragma once

#include <g3r/points.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace g3r::shapes {

/// A sampled closed surface: points, unit outward normals, area per point.
struct Surface {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
  std::vector<double> areas;

  [[nodiscard]] std::vector<Vec3> eta() const {
    std::vector<Vec3> out(points.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      for (std::size_t a = 0; a < 3; ++a) out[i][a] = areas[i] * normals[i][a];
    }
    return out;
  }
};

/// SplitMix64: the same numbers everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  // [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double gaussian() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }
  /// Normal, as the sum of gaussian() nearly is, whose excess kurtosis is -0.1 (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }
  Vec3 direction() {
    const double z = uniform(-1, 1);
    const double phi = uniform(0, 2 * std::numbers::pi);
    const double s = std::sqrt(1 - z * z);
    return {s * std::cos(phi), s * std::sin(phi), z};
  }

 private:
  std::uint64_t state_;
};

/// Ellipsoid of half axes a, b, c: images of a Fibonacci lattice, with exact area elements.
inline Surface ellipsoid(std::size_t n, double a, double b, double c, Vec3 centre = {0, 0, 0}) {
  Surface s;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  const Vec3 axes{a, b, c};
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(n);
    const double r = std::sqrt(1 - z * z);
    const double phi = golden * static_cast<double>(i);
    const Vec3 unit{r * std::cos(phi), r * std::sin(phi), z};
    Vec3 p;
    Vec3 normal;
    double length = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = centre[k] + axes[k] * unit[k];
      normal[k] = unit[k] / axes[k];
      length += normal[k] * normal[k];
    }
    length = std::sqrt(length);
    for (double& v : normal) v /= length;
    s.points.push_back(p);
    s.normals.push_back(normal);
    s.areas.push_back(4 * std::numbers::pi / static_cast<double>(n) * a * b * c * length);
  }
  return s;
}

inline Surface sphere(std::size_t n, double radius = 0.9, Vec3 centre = {0, 0, 0}) { return ellipsoid(n, radius, radius, radius, centre); }

/// Torus around the z axis, points at random (uniform by area) or, with seed 0, on a regular grid of about n points.
inline Surface torus(std::size_t n, double major = 0.6, double minor = 0.25, std::uint64_t seed = 0, Vec3 centre = {0, 0, 0}) {
  Surface s;
  const double pi2 = 2 * std::numbers::pi;
  const auto add = [&](double u, double v, double area) {
    const double ring = major + minor * std::cos(v);
    s.points.push_back({centre[0] + ring * std::cos(u), centre[1] + ring * std::sin(u), centre[2] + minor * std::sin(v)});
    s.normals.push_back({std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)});
    s.areas.push_back(area);
  };
  if (seed != 0) {
    Random random(seed);
    const double area = pi2 * pi2 * major * minor / static_cast<double>(n);
    while (s.points.size() < n) {
      const double v = random.uniform(0, pi2);
      if (random.uniform() * (major + minor) < major + minor * std::cos(v)) add(random.uniform(0, pi2), v, area);
    }
    return s;
  }
  const auto rows = static_cast<int>(std::lround(std::sqrt(static_cast<double>(n) * minor / major)));
  const auto columns = static_cast<int>(std::lround(static_cast<double>(n) / rows));
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const double v = pi2 * (j + 0.5) / rows;
      add(pi2 * (i + 0.5 * (j % 2)) / columns, v, pi2 / columns * pi2 / rows * minor * (major + minor * std::cos(v)));
    }
  }
  return s;
}

/// Adds the faces of a box: random points, uniform by area, `spacing` apart.
inline void append_box(Surface& s, const Vec3& low, const Vec3& high, double spacing, Random& random) {
  for (std::size_t face = 0; face < 6; ++face) {
    const std::size_t axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto points = static_cast<int>((high[u] - low[u]) * (high[v] - low[v]) / (spacing * spacing));
    for (int i = 0; i < points; ++i) {
      Vec3 p{}, n{};
      p[axis] = face % 2 == 0 ? low[axis] : high[axis];
      p[u] = random.uniform(low[u], high[u]);
      p[v] = random.uniform(low[v], high[v]);
      n[axis] = face % 2 == 0 ? -1 : 1;
      s.points.push_back(p);
      s.normals.push_back(n);
      s.areas.push_back(spacing * spacing);
    }
  }
}

/// Square plates one above the other, each closed: random points, uniform by area, `spacing` apart; `thickness` and `gap` in spacings.
inline Surface plates(int count, double side, double thickness, double gap, double spacing) {
  Surface s;
  Random random(4);
  for (int k = 0; k < count; ++k) {
    const double bottom = k * (thickness + gap) * spacing;
    const Vec3 low{-side / 2, -side / 2, bottom};
    const Vec3 high{side / 2, side / 2, bottom + thickness * spacing};
    append_box(s, low, high, spacing, random);
  }
  return s;
}

/// Moves every coordinate of every point by Gaussian noise.
inline void scatter(Surface& s, double sigma) {
  Random random(4);
  for (Vec3& p : s.points) {
    for (double& c : p) c += sigma * random.gaussian();
  }
}

/// The normals, turned at random by about `angle`.
inline std::vector<Vec3> disturbed(std::vector<Vec3> normals, double angle) {
  Random random(3);
  for (Vec3& n : normals) {
    for (double& c : n) c += angle * random.gaussian();
    const double size = std::hypot(n[0], n[1], n[2]);
    for (double& c : n) c /= size;
  }
  return normals;
}

/// Joins two surfaces; `flip` turns the normals of the second (an inner shell faces inwards).
inline Surface join(Surface a, const Surface& b, bool flip = false) {
  for (std::size_t i = 0; i < b.points.size(); ++i) {
    a.points.push_back(b.points[i]);
    const double sign = flip ? -1 : 1;
    a.normals.push_back({sign * b.normals[i][0], sign * b.normals[i][1], sign * b.normals[i][2]});
    a.areas.push_back(b.areas[i]);
  }
  return a;
}

/// Share of normals on the true side.
inline double share_correct(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (normals[i][0] * truth[i][0] + normals[i][1] * truth[i][1] + normals[i][2] * truth[i][2] > 0) ++right;
  }
  return static_cast<double>(right) / static_cast<double>(truth.size());
}

/// mean (1 - n . n_true) / 2
inline double angle_error(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (1 - (normals[i][0] * truth[i][0] + normals[i][1] * truth[i][1] + normals[i][2] * truth[i][2])) / 2;
  }
  return sum / static_cast<double>(truth.size());
}

}  // namespace g3r::shapes
