// How far sensors may be trusted: what they have seen, nothing hides from them.
#pragma once

#include "cloud/point_set.h"

#include <g3r/hints.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace g3r {

/// Of what sensors should have seen.
struct SensorTrust {
  double hidden_share = 0;        ///< share that other points hide from them
  std::vector<double> of_sensor;  ///< of each, 0..1: how far it is
};

/// Sides by sensors that see a share 1 - s of their points are right with this chance, as if they said nothing of a share 2 s of them and
/// the truth of the others: they are trusted to max(0, 1 - 2 s). About a closed thing, as from a wrong place, a half is hidden
/// (is_blocked()). Each point counts by the cosine under which it would be seen squarest. Where points name their sensors each is judged by
/// its own points, and one that stands for those of all; else all together, by points that none of the 16 nearest can see. `points`:
/// indices of those that sensors should have seen; `hints`: in the frame of the set. Looks at about 500 of them and 16 sensors of each at
/// most, O(log N) for each step of is_blocked(). Nothing is hidden in fewer than 192 points. Throws Cancelled.
[[nodiscard]] SensorTrust find_sensor_trust(const PointSet& set, const std::vector<std::uint32_t>& points, const Hints& hints,
                                            const std::atomic<bool>* cancel);

/// Hidden share above which the sensors did not stand there: among pipes and leaves a tenth is.
inline constexpr double kManyHidden = 0.1;

}  // namespace g3r
