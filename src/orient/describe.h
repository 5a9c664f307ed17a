// What a report says of a cloud and of its problem, before anything is solved.
#pragma once

#include "orient/problem.h"

#include <g3r/g3r.h>

#include <cstddef>
#include <vector>

namespace g3r {

/// Writes into `stats` how many points there are and what became of them, the box, spacing, noise and width of the kernels in the units of
/// `points`, the method, and the memory that the solve takes. Warns of points that are not finite and that are too close together for the
/// solver; calls the result doubtful, with a warning, where a given epsilon is so wide that no body in the box of the points has a field
/// above 1/2, or a given noise is larger than the box. `problem`: made of these points with these options. O(N).
void describe(const Problem& problem, const PointsView& points, const Options& options, Stats& stats);

/// Warns of so many of the caller's points that far_points() left out, and calls the result doubtful, where they may be a part of their own
/// (kSmallPart). O(1).
void warn_of_far(std::size_t far, Stats& stats);

/// Warns where all points lie in one plane: nothing but a hint says which side is outside. O(N).
void warn_of_flat(const CanonicalCloud& cloud, Stats& stats);

/// Calls the result inconsistent, with a warning, where the points fill a volume (dimension()): there is no surface then, or the noise
/// hides it. Only of problems that are solved for on clusters: to estimate_noise() a volume looks like noise of 0.75 spacings and more.
void warn_of_volume(const Problem& problem, Stats& stats);

/// Calls the result inconsistent, with a warning, where the points are so few that no side can be certified (kFewestSites), and none is
/// surer than a guess: sides of a few points agree as a rule, and say nothing. O(1).
void warn_of_few_points(const std::vector<float>& confidence, Stats& stats);

}  // namespace g3r
