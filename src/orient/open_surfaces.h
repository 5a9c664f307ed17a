// Sides and directions where the surface has no inside.
#pragma once

#include "cloud/constants.h"
#include "cloud/point_set.h"
#include "orient/confidence.h"
#include "orient/settings.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Open surfaces of a cloud. Empty vectors of parts: there is none.
struct OpenSurfaces {
  static constexpr std::uint32_t kNone = UINT32_MAX;
  std::vector<std::uint32_t> part;   ///< N: number of the open surface a point belongs to (its first point), or kNone: part of a closed one
  std::vector<float> certainty;      ///< N, of the outside: up to 1 where there is one, 0.5 where either side could be it; 0.5 on closed
                                     ///< parts whose field is not at rest, so that their sides are not certified
  std::vector<float> certified;      ///< N, 0..1: how far the field shows the sides of the solution to be right, where they are kept; on
                                     ///< open surfaces, that the side of a point agrees with those around it
  float uncertified = kUndecided;    ///< confidence, at most, of a side that it does not show: a choice, or under noise none
  std::vector<std::uint8_t> agrees;  ///< N: 1 on open surfaces whose sides agree (their mean jump defect is small), 0 elsewhere
  bool is_turned = false;            ///< whether points of closed parts have taken the side of a hypothesis
  std::vector<float> held;           ///< N: chance that a point has the side of the rest of its part (held_by_neighbours()); else 1

  /// Whether point i lies on an open surface; also of points beyond N, such as outliers, which do not.
  [[nodiscard]] bool is_open(std::size_t i) const { return i < part.size() && part[i] != kNone; }
  /// Whether hardly anything shows which side of the open surface that point i lies on is the outside: the corner of a room encloses as
  /// much as half of a thing.
  [[nodiscard]] bool is_choice(std::size_t i) const { return is_open(i) && static_cast<double>(certainty[i]) < kMostOf; }

  /// Makes part, certainty, agrees and held values of N points; those that they have not had lie on a closed part.
  void resize(std::size_t points);
  /// Takes what was found for some of the N points (ascending) without the others.
  void put(const std::vector<std::uint32_t>& some, const OpenSurfaces& here);
};

/// The equations are true of the boundary of a solid. A surface without an inside (terrain, one depth frame, a dental arch) satisfies them
/// too, but with area vectors that lie in it or change their side from place to place. The field of the result shows it: beside a closed
/// surface it is 0 or 1, beside an open one it is not (Certificate::unrest). So every connected part of the cloud (SiteParts) is tested,
/// and may be open
///   - as a whole, where its unrest is above 0.08 or its jump defect above 2/3 (0.8 under noise), unless its points lie on two walls close
///     together (on_two_walls()); where it is not more restless than unrest_of_open(), a hypothesis has to be shown to be better;
///   - if it is at rest as a whole, but not in some pieces (restless_pieces()), where a hypothesis is_shown_better() there.
/// Such parts are tested without the closed ones, and the sides_by_agreement() of neighbours are the hypotheses, from the finest scale on
/// which the samples are a surface (scan lines are one only across their gaps) on. That with the least mean of JumpDefects::all + own is
/// taken, of equal ones the finest: where layers are close to each other, so that a probe of one is behind the next, what no other surface
/// disturbs counts twice. Where the defect of a site is above a half, in a groove narrower than the sampling for instance, the direction is
/// that of a field four site spacings wide, which sees what is around, and the side of a point is not certified in full. Then normals are
/// turned to the outside (face_outside()).
///
/// With e = SiteParts::enclosure() of the best hypothesis, a part with |e| above 2/3 is closed under noise, or if only pieces of it are
/// restless: noise makes one wall of two, and what is left encloses nearly everything. Where a part is neither at rest nor shown to be
/// open, its sides are those of the best hypothesis where the normals of a site and those around it have one side, if |e| is above 2/3 and
/// the mean defect of the hypothesis less than that of the solution; and so they are in the restless pieces of one with |e| above 2/3 if
/// the hypothesis is shown to be better there, as about the base of an object that was not scanned from below. Where the solution stays as
/// it is, certified_sides() says how far its field shows it to be right; all points of a cloud of fewer than 30 have 0, and so have exact
/// parts of fewer. `noise`: standard deviation; `normals`: N unit vectors, in: the solution, out: changed on open surfaces and where closed
/// ones are restless. O(N log N). Throws Cancelled.
[[nodiscard]] OpenSurfaces find_open_surfaces(const PointSet& set, double noise, const SumPlan& sums, std::vector<Vec3>& normals,
                                              const std::atomic<bool>* cancel = nullptr);

/// Whether point i could face either way: confidence below a half, or a half on closed surfaces, whose sides are no choice and which
/// nothing shows to be right. Where there are fewer than 30 points nothing can show it, and a half is no reason. `confidence`: of the N
/// points.
[[nodiscard]] bool is_unsure(const OpenSurfaces& surfaces, const std::vector<float>& confidence, std::size_t i);
/// Share of the points that are so. O(N).
[[nodiscard]] double unsure_share(const OpenSurfaces& surfaces, const std::vector<float>& confidence);

}  // namespace g3r
