// Noise of an oriented cloud: how much there is, and points moved onto the smooth surface that it scatters about.
#pragma once

#include "mesh/field_local_fit.h"

#include <atomic>

namespace g3r::mesh {

struct Noise {
  double position = 0;  ///< standard deviation along the normal, in typical spacings; median over the cloud
  double normal = 0;    ///< root mean square deviation of the normals, in radians; median over the cloud
};

/// `neighbours`: of the positions, `typical`: spacing of the cloud. From the misfit of quadratic height fields to about 48 neighbours, at
/// 4,000 points evenly spread over the indices.
[[nodiscard]] Noise noise_about_fits(const OrientedPoints& points, const Neighbours& neighbours, double typical);

/// The width of the fits that points move onto under a noise, both in spacings: narrower ones leave noise; wider ones round detail and cost
/// their square in time.
[[nodiscard]] double smoothing_width(double position);

/// Moves every point along the normal onto a quadratic fit of smoothing_width(), and takes over the normal of the fit. The noise is a
/// length, the same everywhere: where points are far apart it is little of their spacing, and there is detail to lose. `neighbours`: of a
/// copy of the positions, `typical`: as of noise_about_fits(). O(N) fits over up to 200 points. Throws Cancelled.
void denoise(OrientedPoints& points, const Neighbours& neighbours, const Noise& noise, double typical,
             const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
