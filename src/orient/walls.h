// Whether the walls that were found explain the noisy points.
#pragma once

#include "cloud/heights.h"
#include "cloud/point_set.h"

#include <g3r/points.h>

#include <vector>

namespace g3r {

/// The quadratics that noisy points are projected onto (project_points()), at M places, at most 2000 of the points, the same for any
/// normals, with the same spacing everywhere.
struct PlacesOnWalls {
  std::vector<Vec3> normals;      ///< M, of the places, as given
  std::vector<double> residuals;  ///< M, of the quadratics, in proportion to the noise; negative where too few points are on the side
};
/// `normals`: N unit vectors; `noise` > 0 and `spacing` in the units of the points. A fit for each place.
[[nodiscard]] PlacesOnWalls fit_places(const PointSet& set, const std::vector<Vec3>& normals, double noise, double spacing);

/// How far points lie from their wall: the median of the residuals, 1 or a little less where the normals are right; more where two walls
/// are taken for one, and at creases. 1 if no place has a quadratic. O(M).
[[nodiscard]] double misfit(const PlacesOnWalls& places);

/// Share in [0, 1] of the places of one set of points whose normals face the other way afterwards, among those with a quadratic in both; 0
/// if there is none. O(M).
[[nodiscard]] double turned_share(const PlacesOnWalls& before, const PlacesOnWalls& after);

/// The excess kurtosis of the heights of the points on the side (SameSide) of each of these places over a cubic, within twice the reach
/// of the quadratics and 5 times the noise: below 0 where two walls that the noise hides are taken for one (MeanExcess). Of the places that
/// have twice as many points on their side as a cubic has terms; 0 if there are none. Arguments as above. A fit for each place.
[[nodiscard]] MeanExcess excess_about_walls(const PointSet& set, const std::vector<Vec3>& normals, double noise, double spacing);

}  // namespace g3r
