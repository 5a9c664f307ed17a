// The normal distribution, and what chance puts on a slab: detection a contrario (Desolneux, Moisan and Morel, "From Gestalt Theory to
// Image Analysis", 2008).
#pragma once

#include <cstddef>
#include <vector>

namespace g3r {

/// One in fifty: of all that is found, planes, slabs and outliers, what chance alone would put there. More takes rows of noise for planes
/// and sparse points of surfaces, of which meshes lack parts, for outliers; less leaves narrow facets and strays, which open closed
/// surfaces.
inline constexpr double kFalseAlarms = 0.02;

/// Whether these are more than half of all, numbers or shares: only one thing can be so of most.
[[nodiscard]] inline bool is_majority(double some, double all) { return 2 * some > all; }

/// P(X <= x) of a normal distribution of mean 0 and deviation 1.
[[nodiscard]] double normal_distribution(double x);

/// Share of a ball that is no farther from a plane through its centre than `height` of its radii.
[[nodiscard]] double share_of_ball(double height);

/// P(Binomial(n, share) >= k), k = 0 ... n, 0 < share.
[[nodiscard]] std::vector<double> chances_of_as_many(std::size_t n, double share);

/// How many of n points that each lie in any of `tests` places by chance as often as `share` prove a place: the least k with
/// tests P(Binomial(n, share) >= k) <= kFalseAlarms; n + 1 where not even all do.
[[nodiscard]] std::size_t proving_number(std::size_t n, double share, double tests);

}  // namespace g3r
