// What one Gaussian splat stops of light, and how it appears along an axis.
// Source: Kerbl, Kopanas, Leimkuehler, Drettakis, "3D Gaussian Splatting for Real-Time Radiance Field Rendering", 2023.
#pragma once

#include "base/vector.h"
#include "io/splat_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace g3r::io {

/// Renderers do not draw what stops less of the light, so it stops none here.
inline constexpr double kFaintest = 1.0 / 255;

/// Whether a splat stops any light: it is not too faint, and its centre and scales are finite.
[[nodiscard]] bool is_drawn(const Splat& splat);

/// Square of the Mahalanobis distance of a place from the centre of a splat that is drawn.
[[nodiscard]] inline double squared_distance(const Splat& splat, const Vec3& place) {
  const Vec3 d = vector::subtract(place, splat.centre);
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = vector::dot(d, splat.axes[k]) / splat.scale[k];
    sum += along * along;
  }
  return sum;
}

/// The share of the light, 0..1, that a splat takes at a place where the square of the Mahalanobis distance is so much.
[[nodiscard]] inline double taken(const Splat& splat, double squared) {
  const double share = splat.opacity * std::exp(-squared / 2);
  return share >= kFaintest ? std::min(share, 1.0) : 0;
}

/// A splat as it appears along an axis.
struct SplatImage {
  double x = 0, y = 0, depth = 0;
  double xx = 0, xy = 0, yy = 0;  ///< inverse of its covariance
  double width = 0, height = 0;   ///< half sides of what is drawn
};

/// Of a splat that is drawn. The directions are unit vectors, at right angles; depth grows along `ahead`.
[[nodiscard]] SplatImage image_of(const Splat& splat, const Vec3& right, const Vec3& up, const Vec3& ahead);

}  // namespace g3r::io
