#include "io/splat_image.h"

namespace g3r::io {
namespace {

using vector::dot;

constexpr double kEdgeOn = 1e-6;      // A disc seen from its edge has this share of its spread across: it keeps a place in the picture.
constexpr double kLargest = 1e100;    // Coordinates and scales up to this have squares of products that are finite,
constexpr double kSmallest = 1e-100;  // and from this on such that are above 0.

// m^2 at which it is drawn no more.
double squared_reach(const Splat& splat) { return 2 * std::log(splat.opacity / kFaintest); }

}  // namespace

bool is_drawn(const Splat& splat) {
  const auto sound = [](double value) { return std::abs(value) <= kLargest; };
  return std::all_of(splat.centre.begin(), splat.centre.end(), sound) &&
         std::all_of(splat.scale.begin(), splat.scale.end(), [](double s) { return s >= kSmallest && s <= kLargest; }) &&
         splat.opacity >= kFaintest;
}

SplatImage image_of(const Splat& splat, const Vec3& right, const Vec3& up, const Vec3& ahead) {
  SplatImage image{dot(right, splat.centre), dot(up, splat.centre), dot(ahead, splat.centre)};
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = splat.scale[k] * dot(right, splat.axes[k]), y = splat.scale[k] * dot(up, splat.axes[k]);
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  const double least = kEdgeOn * (xx + yy);
  xx += least;
  yy += least;
  const double reach = squared_reach(splat);
  image.width = std::sqrt(reach * xx);
  image.height = std::sqrt(reach * yy);
  const double scale = xx + yy;  // the determinant of scales of 1e-100 would be 0
  const double determinant = (xx / scale) * (yy / scale) - (xy / scale) * (xy / scale);
  image.xx = yy / scale / determinant / scale;
  image.xy = -xy / scale / determinant / scale;
  image.yy = xx / scale / determinant / scale;
  return image;
}

}  // namespace g3r::io
