// How far sensors may be trusted: what they have seen, nothing hides from them.
#pragma once

#include "cloud/point_set.h"
#include "orient/hints.h"

#include <g3r/hints.h>

#include <atomic>
#include <vector>

namespace g3r {

/// Of what sensors should have seen.
struct SensorTrust {
  double hidden_share = 0;        ///< share that other points hide from them
  std::vector<double> of_sensor;  ///< of each, 0..1: how far it is
};

/// Sides by sensors that see a share 1 - s of their points are right with this chance, as if they said nothing of a share 2 s of them and
/// the truth of the others: they are trusted to max(0, 1 - 2 s). About a closed thing, as from a wrong place, a half is hidden
/// (is_blocked()). Only open parts of the cloud are asked, where votes of sensors count; each point counts by the cosine under which it
/// would be seen squarest. Where points name their sensors each is judged by its own points, and one that stands for those of all; else all
/// together, by points that none of the 16 nearest can see. Looks at about 500 points and 16 sensors of each at most, O(log N). Throws
/// Cancelled.
[[nodiscard]] SensorTrust find_sensor_trust(const PointSet& set, const Patches& patches, const Hints& hints,
                                            const std::atomic<bool>* cancel);

}  // namespace g3r
