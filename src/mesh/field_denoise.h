// Noise of an oriented cloud: how much there is, and points moved onto the smooth surface that it scatters about.
#pragma once

#include "mesh/field_local_fit.h"

#include <atomic>

namespace g3r::mesh {

struct Noise {
  double position = 0;  ///< standard deviation along the normal, in spacings; median over the cloud
  double normal = 0;    ///< root mean square deviation of the normals, in radians; median over the cloud
};

/// `neighbours`: of the positions. From the misfit of quadratic height fields to about 48 neighbours, at 4,000 points evenly spread over
/// the indices.
[[nodiscard]] Noise estimate_noise(const OrientedPoints& points, const Neighbours& neighbours);

/// The width in spacings of the fits that points move onto under a noise: narrower ones leave noise; wider ones round detail and cost their
/// square in time.
[[nodiscard]] double smoothing_width(double position);

/// Moves every point along the normal onto a quadratic fit of smoothing_width(), and takes over the normal of the fit.
/// `neighbours`: of a copy of the positions. O(N) fits over up to 200 points. Throws Cancelled.
void denoise(OrientedPoints& points, const Neighbours& neighbours, const Noise& noise, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
