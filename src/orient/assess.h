// How certain the sides of a solution are, and what a report says of it.
#pragma once

#include "cloud/heights.h"
#include "orient/problem.h"
#include "orient/solution.h"

#include <g3r/g3r.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// A solution and how far to trust it.
struct Oriented {
  Solution solution;
  std::vector<float> confidence;  ///< N, 0..1: of the side of every point
  double doubt = 0;               ///< share of the wanted points that could face either way by their own equations, or lie on open surfaces
  double agreed = 0;  ///< share of the wanted points that lie on open surfaces whose sides agree: these could face either way, but together
  MeanExcess about_walls;  ///< of the heights of noisy points about what was found, if not all of it is open
};

/// The confidence of a solution's sides is, in this order,
///   - side_confidence(), under noise of the sums over the points near each one (sums_over());
///   - on open surfaces, whose sides do not come from the equations, their certainty instead, as far as a point has the side of its part
///     (both_agree() with OpenSurfaces::held); elsewhere times their certainty, which is a half on parts whose field is not at rest;
///   - c l + (1 - c) u with the certificate c of a side, the confidence l that came out so far, and u what an uncertified side is worth:
///     OpenSurfaces::uncertified at most, and nothing on open surfaces, where c says whether neighbours agree;
///   - half of that on closed parts where noise hides walls (MeanExcess::is_two_walls()): the field of one wall is right, and half of the
///     points are on the other;
///   - limit_to_evidence().
/// The last three are left out with Step::kCertificate, and `doubt` is from before them: it asks what the solution says of itself. Adds to
/// `stats` the mean confidence and the shares of unsure, open and undecided points, and whether the result is consistent, which it is where
/// no more than a fifth of the points (kManyUnsure) are unsure, undecided or both; warns of what is doubtful. Where everything is open
/// nothing depends on the solver, and it counts as converged. O(N).
[[nodiscard]] Oriented assess(const Problem& problem, Solution solution, Stats& stats);

/// Sets the mean confidence, the shares of unsure points and of those whose side is a choice, and `consistent`. `decided`: N, those that
/// are none any more, as hints decide them; empty: none. O(N).
void summarise_sides(const OpenSurfaces& surfaces, const std::vector<float>& confidence, const std::vector<std::uint8_t>& decided,
                     Stats& stats);

/// Warns where more than a fifth of the points are unsure: once, of the final sides. O(N).
void warn_of_unsure(const OpenSurfaces& surfaces, const std::vector<float>& confidence, Stats& stats);

}  // namespace g3r
