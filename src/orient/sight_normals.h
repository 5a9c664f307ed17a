// Directions and sides of noisy points from the lines of sight that they were seen along.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <atomic>
#include <vector>

namespace g3r {

/// Noise along the lines of sight.
struct SightNoise {
  double deviation = 0;      ///< standard deviation of the depths; 0 where none shows
  std::size_t together = 1;  ///< points next to each other that are off by as much: more than one where depths are in steps
};

/// Noise leaves the same residual however many points are fitted, and shape leaves the more the farther these reach: of quadratics in the
/// angle it grows eightfold from 24 points to 96, from those to 384. So the residual, in the median of about 500 places, is noise where it
/// grows by less than sqrt(2). Depths in steps (disparities of a camera) leave less on few points than on those of several steps: errors of
/// as many points as it stops growing from are one. `set`: Views are known, and 1 in 16 points of each are 384, or what is wider does not
/// count. O(500 log N).
[[nodiscard]] SightNoise find_sight_noise(const PointSet& set, const std::atomic<bool>* cancel = nullptr);

/// What normals_by_sight() finds.
struct SightNormals {
  std::vector<Vec3> normals;     ///< N unit vectors that face the sensor of their point
  std::vector<float> certified;  ///< N, 1/2..1: the chance that the surface faces the sensor on the side that its normal has
};

/// A sensor measures depth: noise moves a point along its line of sight, and which line that is it leaves as it was. So the neighbours of
/// a point are those with the nearest lines of sight, whatever their depth, and a plane n . p = c seen from 0 is linear in them:
///   1 / rho_j = m . d_j,   m = n / c,   p_j = rho_j d_j
/// of which least squares have no bias, as those in space have where noise is as large as the spacing. Weights are 1 - r^2 / R^2
/// (Epanechnikov) in the angle, times (1 - (e / 5 sigma)^2)^2 (Tukey's biweight) of the residual e along the sight, in four rounds: what is
/// in front of an edge does not count behind it. Of 24 points; where errors of several are one, of 24 to 384 that stand for more, twice as
/// many while the normal stays within sqrt(2) times what such errors turn that of each narrower fit by, sigma sqrt(6 / n) / R of n
/// independent ones (Lepski; noisy_jets.h). The surface faces the sensor, as m . d > 0. The normal has a standard deviation s from the
/// residuals, and is edge-on at an angle a: Phi(a / s) is certified. `set`: Views are known, of at least 24 points each; `noise`: standard
/// deviation, above 0. O(N log N). Throws Cancelled.
[[nodiscard]] SightNormals normals_by_sight(const PointSet& set, const SightNoise& noise, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r
