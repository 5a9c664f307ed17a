// The sides of flat facets, whole facets at a time.
#pragma once

#include "base/stages.h"
#include "base/vector.h"
#include "cloud/point_set.h"
#include "orient/settings.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// A plane through the middle of what it holds.
struct FacetPlane {
  Vec3 normal{0, 0, 0};  ///< unit length, either side
  Vec3 middle{0, 0, 0};

  [[nodiscard]] double height(const Vec3& p) const { return vector::dot(normal, vector::subtract(p, middle)); }
};

/// Sets of points side by side in one plane.
struct Facets {
  static constexpr std::uint32_t kNone = UINT32_MAX;
  std::vector<std::uint32_t> of;  ///< N: number of the facet of every point, or kNone
  std::size_t count = 0;
  std::vector<FacetPlane> planes;  ///< `count`: least squares planes of their points
};

/// Grows facets over the 16 nearest points from proven seeds, those first around which most points are in their plane. A facet takes what
/// is beside one of its points and within kExactScatter h or 2.5 `scatter` of its plane, which is fitted anew whenever the points have
/// doubled, if its normal is proven and parallel, on either side, to that of the plane: to 2.6 degrees, or to 2.5 standard errors of the
/// normals of find_scattered_plane(); of others, once the plane is fitted, to 26 degrees. Until then distances are those of two points that
/// scatter. Sets of fewer than 6 points are no facets, nor are those without a wanted point. h: smoothed_spacing(); `proven`: fit_jets() or
/// fit_planes() found its normal; `scatter`: facet_scatter(), same units as the points; `wanted`: N, or empty for all. O(N).
[[nodiscard]] Facets find_facets(const PointSet& set, const std::vector<std::uint8_t>& proven, const std::vector<Vec3>& normals,
                                 double scatter, const std::vector<std::uint8_t>& wanted = {});

/// Share of the wanted points (share_of_wanted()) whose normal is on another side than that of most points of their facet. O(N).
[[nodiscard]] double minority_share(const Facets& facets, const std::vector<Vec3>& normals, const std::vector<std::uint8_t>& wanted = {});

/// Turns single points that are on another side than most of their facet: where most of the nearest points on it are so too, itself
/// included. Larger parts of a facet that differ from the rest stay. `normals`: N, in and out. O(N).
void turn_single_points(const PointSet& set, const Facets& facets, const std::vector<std::uint8_t>& wanted, std::vector<Vec3>& normals);

/// One side for every facet. Single points of a wall thinner than the spacing cannot tell their side, the whole facet can: the energy
/// form's equations are restricted to area vectors eta_i = c_f A_i n_i on facets, with one unknown c_f per facet, its n_i on one side, and
/// free ones elsewhere, which is Galerkin's method with the orthogonal projector P onto these: P M P eta = P b, by conjugate gradients from
/// `eta`. Facets are unsure whose points disagree or whose c_f is below 2/3 in `eta`; what is solved for are the points around them
/// (around_unsure()), the others are held. On unsure facets n_i gets the side of c_f, and eta_i becomes A_i n_i on all; the others stay.
/// docs/math.md, "Facets". A_i: square of the smoothed_spacing(). `eta`, `normals`: in and out. Up to 60 products, 20 to 40 as a rule.
void choose_facet_sides(const PointSet& set, const Settings& settings, const Facets& facets, std::vector<Vec3>& eta,
                        std::vector<Vec3>& normals, Stages& stages);

}  // namespace g3r
