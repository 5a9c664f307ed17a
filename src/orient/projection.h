// Noisy points moved onto their surface, through the points around them that lie on the same side.
#pragma once

#include "cloud/neighbours.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <vector>

namespace g3r {

/// Reach R of the fits, in proportion to sqrt(sigma h) for noise sigma and points h apart: noise turns all of them by the same angle then,
/// as it turns one by about sigma h / R^2. Half the area of the first reach of fit_noisy_jets(), as heights ask for fewer points than
/// slopes; from 0.8 to 1.2 of it the errors are within 1 %.
[[nodiscard]] double projection_reach(double noise, double spacing);

/// Standard deviation of the height at the centre of a quadratic fitted with weights 1 - r^2 / R^2 within the reach R to points that lie h
/// apart (one for each square of side h) and scatter by sigma: sigma h / R sqrt(72 / (15 pi)), as its equivalent kernel is
/// (6 / pi) (1 - r^2) (1 - 2 r^2) on the unit disk (Fan and Gijbels, "Local Polynomial Modelling and Its Applications", 1996). At most
/// sigma.
[[nodiscard]] double projected_noise(double noise, double spacing);

/// Every point goes along the normal of a quadratic height field onto it, which is fitted, within projection_reach() across n_i, to the
/// points on its side (SameSide): the projection of moving least squares (Alexa et al., "Computing and rendering point set surfaces", IEEE
/// TVCG 2003), but for one wall at a time. A point moves by 2.5 sigma at most, which is as far as noise carries it. Where fewer than 12
/// points, twice the terms of a quadratic, are on its side, or the fitted normal is more than 60 degrees from n_i, it stays; as it does
/// rather than leave [-1, 1]^3. `normals`: unit vectors, whose sides may be wrong, wall by wall; `spacing`: h at every point, or one for
/// all; `noise` > 0. In the order of `points`. Throws Cancelled. O(N) for as many points within the reach.
[[nodiscard]] std::vector<Vec3> project_points(const std::vector<Vec3>& points, const Neighbours& tree, const std::vector<Vec3>& normals,
                                               double noise, const std::vector<double>& spacing, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r
