// What the page and the picture share: validation of a scene, and its extent.
#pragma once

#include <g3r/view.h>

#include <cmath>
#include <string_view>

namespace g3r::view {

inline bool is_finite(const Vec3& p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

/// Axis-aligned box of the finite points and of the vertices that triangles use.
struct Box {
  Vec3 low{0, 0, 0};
  Vec3 high{0, 0, 0};
  [[nodiscard]] Vec3 centre() const { return {low[0] / 2 + high[0] / 2, low[1] / 2 + high[1] / 2, low[2] / 2 + high[2] / 2}; }
  [[nodiscard]] double longest_side() const;
};

/// Throws InvalidInput where the contract of Scene is broken, else returns its box.
Box check_scene(const Scene& scene);

/// Typical distance between neighbours, the square root of the area per point: counts occupied cells of a grid. O(N).
double estimate_spacing(const std::vector<Vec3>& points, const Box& box);

/// (1 - n . t) / 2 for unit directions of n and t: 0 agreement, 1 opposite; 1/2 if either is zero or not finite.
float normal_error(const Vec3& n, const Vec3& t);

/// n / |n|, or (0, 0, 0) if n is zero or not finite.
Vec3 unit_or_zero(const Vec3& n);

}  // namespace g3r::view
