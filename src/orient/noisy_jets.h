// Normals of noisy points from quadratic fits, as wide as the points allow.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace g3r {

/// Reach over sqrt(s h) of fits to the points of one wall that scatter by s and lie h apart, of which normals take kWider times as much at
/// first: less leaves more of the error, more blurs detail and takes it for noise.
inline constexpr double kNoiseReach = 3;

/// The winding gradient of a noisy cloud has one width for all points: it blurs what is narrower and leaves noise where the surface is
/// smooth. n_i becomes the normal above p_i of a quadratic height field fitted to the points on its side (n_j . n_i > 0.5) within a reach R
/// along the tangent plane, weights 1 - r^2 / R^2 (Epanechnikov), and, with weight (R/4)^2, to their normals. Noise of standard deviation s
/// disturbs its slope, fitted to n points, by t = s sqrt(6 / sum of the weights) / R sqrt(n / (n - 6)), the wider the less; a fit wider
/// than the surface is smooth is bent. So R grows from 3 sqrt(2 s h) on, sqrt(2) times each, from h at least and up to 2000 points, while
/// the normal stays within t of that of each smaller reach (Lepski, "On a problem of adaptive estimation in Gaussian white noise", Theory
/// of Probability and its Applications 1991; for point clouds: Wang et al., "Bandwidth selection and reconstruction quality in point-based
/// surfaces", IEEE TVCG 2009). One fit serves all points of the side within R/4: three to five of them where it is smooth.
///
/// s is the noise of the cloud or, where that is less, that of the place: of 256 points in a row the median misfit, at every 17th, of a
/// quadratic height field to the points within 3 h.
///
/// Where more than 2 % of the points about the fit face the other way, a wall is as thin as the noise, and the side of a normal says more
/// than its direction: n_i stays, as it does where the fitted normal is more than 60 degrees off. Sides are kept but for normals that were
/// all but in the surface.
///
/// Blocks of points in canonical order share fits; `noise`: of the cloud, > 0; h: the typical spacing; `wanted`: 1 for points whose normals
/// are to be fitted, empty for all; `normals`: N unit vectors, consistent sides. Throws Cancelled. docs/math.md, "Fits of noisy points".
/// O(N).
void fit_noisy_jets(const PointSet& set, double noise, const std::vector<std::uint8_t>& wanted, std::vector<Vec3>& normals,
                    const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r
