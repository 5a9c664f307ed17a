// Planes that hold more points than chance would put there.
#pragma once

#include "cloud/constants.h"
#include "cloud/spacing.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace g3r {

/// Nearest points that a search for a plane looks at: the point itself, first, and 32 others, which reach twice as far as those that say
/// how far apart points are.
inline constexpr std::size_t kPlaneNeighbours = kTwiceAsFar * kClosest + 1;
/// As many of a wall that may not be alone, which reach twice as far again: fewer follow the noise, more the shape.
inline constexpr std::size_t kWallNeighbours = kTwiceAsFar * kPlaneNeighbours;

/// Points of a CAD model lie on its facets to rounding, and more of them on one plane than chance would put there prove it, however narrow
/// the facet and however close the wall behind it.
struct ExactPlane {
  std::vector<std::uint32_t> points;  ///< on it, nearest first; none: there is no such plane
  Vec3 normal{0, 0, 0};               ///< of the least squares plane through them, either side
  /// Their middle principal spread over the largest: 0 along a line, 1 all around. A surface holds no less than kClearlyLess; the rows of a
  /// raster lie in narrow strips of planes across it, and lines are as broad as their noise over their length.
  double breadth = 0;
};

/// The plane through points[index[0]] that holds most of the points `index` (at most kPlaneNeighbours, nearest first): 6 or more to within
/// kExactScatter of their spacing, `spacing` > 0. Candidates are the planes through the first and two of the next 11 (every pair, as RANSAC
/// would in the limit: Fischler and Bolles, "Random sample consensus", Communications of the ACM 1981); the best is fitted to what it
/// holds. Points along a line, which a curved surface has in planes across it, prove nothing: their middle principal spread has to be 0.15
/// of the largest. With `towards` (unit length), of equal ones the one least off it counts. Of random points on a smooth or noisy surface
/// few have such a plane; rows of a raster have one across it. About 3 us.
[[nodiscard]] ExactPlane find_exact_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing,
                                          const Vec3* towards = nullptr);

/// The first of the points, through which planes are looked for, and those of the others that a plane (ExactPlane::points) does not hold.
[[nodiscard]] std::vector<std::uint32_t> beside_plane(const std::vector<std::uint32_t>& index, const std::vector<std::uint32_t>& held);

/// find_exact_plane() among points that scatter by `scatter` (standard deviation, above 0) about their surfaces. The plane has to hold, to
/// within 2.5 `scatter`, so many points that points which fill the ball of the 33 would give as many to any of the 55 candidates by chance
/// kFalseAlarms times (binomial law: detection a contrario, Desolneux, Moisan, Morel, "Meaningful alignments", International Journal of
/// Computer Vision 2000): 8 of 33 for a scatter of 0.01 spacings, 10 for 0.04, 13 for 0.08; from 0.15 on that is more than half of them,
/// and there is none. It is fitted anew to what it holds for as long as that becomes more, and must not be the plane of a bend: a quadratic
/// height field through the same points may not be likelier by Schwarz's criterion (three more numbers cost 3/2 ln n). docs/math.md,
/// "Planes of scattered points". About 8 us.
[[nodiscard]] ExactPlane find_scattered_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing,
                                              double scatter, const Vec3& towards);

/// Spacings: points that scatter less are exact. Above the rounding of files and of a box far larger than the spacing; noise that matters
/// is far above.
inline constexpr double kExactScatter = 0.001;

/// What find_likeliest_plane() finds.
struct LikeliestPlane {
  ExactPlane plane;
  double scatter = 0;  ///< of the points about it, in spacings; 0: there is no such plane
};

/// The plane through points[index[0]] that is least likely to be one of chance, of all scatters of 1, 2, 4, ..., 128 times kExactScatter;
/// none if none is proven as above, if what it holds is clearly less broad than long (kClearlyLess), if it is a bend, or not `is_of_facet`.
/// A wall has two sides, which together are one plane of half its thickness in scatter: so what a parallel plane at least 10 scatters away
/// holds counts with the plane, any of the other points being where that could be. docs/math.md, "Planes of scattered points". About 30 us.
[[nodiscard]] LikeliestPlane find_likeliest_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing,
                                                  const std::function<bool(const LikeliestPlane&)>& is_of_facet);

}  // namespace g3r
