// Sides of the patches of open surfaces, by what hints say of their points.
#pragma once

#include "orient/hints.h"
#include "orient/votes.h"

namespace g3r {

/// A patch takes the side that most of its votes (Voters) are for; one that is seen edge-on but for rounding keeps its side. It takes a
/// share of the votes above the `certainty` of a side to turn it, but no more than two thirds. Where that was a choice the chance of the
/// side becomes that of both (both_say()); of a point it is that times the chance that it has the side of its patch (both_agree() with
/// `held`), or the chance (1 + v) / 2 that a point seen at the cosine v has by itself, if that is more. No chance is above two thirds of
/// what stands `over_others`, where up alone decides. Its side is decided from two thirds on, and wherever all points have been `seen` by
/// the sensors. The confidence is the chance times `agreed`.
///
/// Then pieces of a patch that are not consistent with the rest of it are turned where their votes, v in the mean, say more against them
/// than `held` does for them (both_say() of the two); the chance of their points is 1 - `held` then. A piece ends too where adjacent points
/// object to each other more than at a horizon, and what hangs together with it by a few pairs of points only, as in a crevice, is turned
/// by itself. The middle of a scene seen from inside says nothing of single points, and of pieces only where nothing else does.
///
/// What of open parts still faces away from all sensors that may have seen it, at a cosine v < 0, has a confidence of (1 + v) / 2 at most;
/// where all points have been `seen`, what would be seen squarely from behind is turned, with (1 - v) / 2, and elsewhere what is held by
/// less than (1 - v) / 2. Marks points in HintEffect::turned and decided, N each and 0 before, and writes HintEffect::agreement and the
/// confidence; normals stay as they are. O(N log(sensors) + N k), and all sensors for each open point that none of them sees from the
/// front.
void decide_patches(const HintedCloud& cloud, Voters& voters, HintEffect& effect);

}  // namespace g3r
