// Which Gaussian splats are where light is stopped: the others are no points of a surface.
// Sources: Kerbl, Kopanas, Leimkuehler, Drettakis, "3D Gaussian Splatting for Real-Time Radiance Field Rendering", 2023 (how splats are
// drawn); Yu, Sattler, Geiger, "Gaussian Opacity Fields", 2024 (the surface is where half of the light is stopped).
#pragma once

#include <g3r/points.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

namespace g3r::io {

/// An ellipsoid whose opacity falls off as exp(-m^2 / 2) with the Mahalanobis distance m from its centre.
struct Splat {
  Vec3 centre{0, 0, 0};
  std::array<double, 3> scale{1, 1, 1};                                          ///< standard deviations along its axes
  std::array<std::array<double, 3>, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< unit vectors
  double opacity = 1;                                                            ///< at the centre, 0..1
};

/// The axes of a splat turned by a quaternion w x y z of any length; those of the coordinates if the length is 0 or not finite.
[[nodiscard]] std::array<std::array<double, 3>, 3> axes_of(const std::array<double, 4>& quaternion);

enum class SplatPlace : std::uint8_t {
  kSurface,      ///< light from outside gets there and is stopped
  kTranslucent,  ///< at its centre the splats together stop less than half of the light: a floater, or too faint to be drawn
  kHidden        ///< from none of 64 sides more than half of the light gets there: inside
};

/// The place of every splat. Light comes in parallel rays along 32 axes, from both ends; a splat takes from the ray through the centre of
/// another what a renderer draws of it there, unless that centre lies within it: those are of one layer. Translucent ones take nothing, and
/// as in renderers nothing is drawn of less than 1/255. Where more than a third would be hidden the pictures were taken from within, in a
/// room or a landscape, and none is. Splats that are not finite are kSurface. O(N log N), about 40 us of one core a splat: each ray looks
/// at 4096 splats at most, and where that does not decide it the splat counts as surface. `threads`: 0 for all cores, the result does not
/// depend on it. Throws Cancelled when `cancel` (may be null) becomes true.
[[nodiscard]] std::vector<SplatPlace> places_of(const std::vector<Splat>& splats, int threads = 0,
                                                const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::io
