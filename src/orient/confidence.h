// How far to trust the side of each normal.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Confidence in a side that is a choice, or that nothing shows to be right; below it the other side is likelier, and the point unsure.
inline constexpr float kUndecided = 0.5F;

/// Confidence in the side of each normal, in [0, 1]: c = a m f with
///   a = (1 + cos angle(eta_i, n_i)) / 2              solved and refined directions agree
///   m = min(1, 2 A_i / median A), A = |eta| / area   wrong points find little of their area: about 0.2 of the median
///   f = min(1, 2 G_i / median G), G = |grad w| s     and lie where the field is weak; 1 without a refinement (empty `jumps`)
/// with `areas` what each vector would be long if all was found, up to one factor, or one for all, and G the `jumps`, those of
/// Refinement::strength. It must rank wrong sides on noisy data with AUC > 0.85 (tests/sides_under_noise_test).
[[nodiscard]] std::vector<float> side_confidence(const std::vector<Vec3>& eta, const std::vector<Vec3>& normals,
                                                 const std::vector<double>& jumps, const std::vector<double>& areas);

/// Sums over the near points of each one. Under noise the vectors of single points fit the noise; those of a place together tell its side,
/// and how far they are one direction (the mean resultant length of directional statistics, as in concentration()) how surely, whatever the
/// density.
struct Sums {
  std::vector<Vec3> vectors;    ///< N: of their vectors
  std::vector<double> lengths;  ///< N: of the lengths of these
};
/// Of N vectors; `near`: Neighbours::of_all(k) of their points, each its own near point too. O(N k).
[[nodiscard]] Sums sums_over(const std::vector<std::uint32_t>& near, const std::vector<Vec3>& vectors);

/// What n = N / kSpacingNeighbours independent neighbourhoods can show of sides. Were they n trials of which a share c succeeded, the next
/// would succeed with the expected chance (c n + 1) / (n + 2) = 1/2 + (c - 1/2) n / (n + 2) (rule of succession; Laplace, "Memoire sur la
/// probabilite des causes par les evenements", 1774): so much is left of a confidence c above a half. Where less is shown nothing changes,
/// and the order of the points stays. `points`: N, distinct. O(N).
void limit_to_evidence(std::size_t points, std::vector<float>& confidence);

/// Chance that two sides are the same, or both not, of the independent chances that each is: a half if either is a choice.
[[nodiscard]] inline double both_agree(double one, double other) { return one * other + (1 - one) * (1 - other); }

/// Chance of a side of which two independent observations say that it has these chances, not both 0 or 1 against each other (Bayes).
[[nodiscard]] inline double both_say(double one, double other) { return one * other / (one * other + (1 - one) * (1 - other)); }

/// Of every point, whether its side_confidence() is below a half.
[[nodiscard]] std::vector<std::uint8_t> unsure_points(const std::vector<float>& confidence);
/// Share of the wanted points (share_of_wanted()), of at least one, whose side_confidence() is below a half. O(N).
[[nodiscard]] double unsure_share(const std::vector<float>& confidence, const std::vector<std::uint8_t>& wanted = {});
/// Share of unsure sides from which more steps and other noises are tried: few clean clouds leave as many, and with a larger share thin
/// parts, and scans that do not fit onto each other, would stay wrong.
inline constexpr double kDoubtful = 0.05;
/// Share of the points on a doubtful side, from which facets or projected points are solved for, and once more: fewer are not worth it.
inline constexpr double kMinMinority = 1e-3;
/// Rounds of what goes on from its own result, at most: solving for facets, projecting points and polishing, taking the winding gradient
/// for the normals. Points on no facet come right only after those on facets, and what a third round has not turned a fourth does not
/// either.
inline constexpr int kMostRounds = 3;
/// Share of unsure points above which the orientation is called inconsistent, or of those that have been unsure a remedy no good.
inline constexpr double kManyUnsure = 0.2;

}  // namespace g3r
