// Points with sides, for the tests of what hints make of them.
#pragma once

#include "cloud/neighbours.h"
#include "orient/hints.h"

#include <g3r/hints.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace g3r::sides {

inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 between(const Vec3& from, const Vec3& to) { return {to[0] - from[0], to[1] - from[1], to[2] - from[2]}; }

// Points with sides, and the patches they belong to.
struct Sides {
  std::vector<Vec3> points, normals, eta;
  std::vector<float> confidence;
  Patches patches;
  double spacing = 0.1;

  void add(const Vec3& point, const Vec3& normal, std::uint32_t patch, bool is_choice) {
    points.push_back(point);
    normals.push_back(normal);
    const double area = spacing * spacing;
    eta.push_back({area * normal[0], area * normal[1], area * normal[2]});
    confidence.push_back(is_choice ? 0.5F : 1.0F);
    patches.of.push_back(patch);
    patches.certainty.push_back(is_choice ? 0.5F : 1.0F);
  }
  // A square of side 2 about `centre`, along the axes other than `axis`, whose normals are `sign` times that axis.
  void add_square(const Vec3& centre, std::size_t axis, double sign, std::uint32_t patch, bool is_choice = true) {
    Vec3 normal{0, 0, 0};
    normal[axis] = sign;
    for (int i = 0; i < 20; ++i) {
      for (int j = 0; j < 20; ++j) {
        Vec3 p = centre;
        p[(axis + 1) % 3] += 0.1 * i - 0.95;
        p[(axis + 2) % 3] += 0.1 * j - 0.95;
        add(p, normal, patch, is_choice);
      }
    }
  }
  // A sphere, closed, or its part above `least_z` times the radius as a patch.
  void add_sphere(const Vec3& centre, double radius, double least_z = -1, std::uint32_t patch = Patches::kNone, bool is_choice = false) {
    const int count = static_cast<int>(4 * std::numbers::pi * radius * radius / (spacing * spacing));
    for (int i = 0; i < count; ++i) {
      const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), turn = 2.399963 * i;
      const Vec3 n{r * std::cos(turn), r * std::sin(turn), z};
      if (z < least_z) break;
      add({centre[0] + radius * n[0], centre[1] + radius * n[1], centre[2] + radius * n[2]}, n, patch, is_choice);
    }
  }
  HintEffect follow(const Hints& hints) {
    return follow_hints({points, Neighbours(points).of_all(9), spacing, patches, hints, {normals, eta, confidence}});
  }
};

}  // namespace g3r::sides
