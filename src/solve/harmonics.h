// Real regular solid harmonics: the harmonic polynomials u of Green's identity.
#pragma once

#include "sum/harmonic_values.h"

#include <g3r/points.h>

#include <string>
#include <vector>

namespace g3r {

/// u_lm, orthonormal on the unit sphere: degree l >= 0, order m in -l..l (m > 0: cos(m phi), m < 0: sin(|m| phi)).
/// u_00 = 0.28209, u_1m = 0.48860 {y, z, x} for m = -1, 0, 1, u_2m = 1.09255 {xy, yz, . , xz}, 0.31539 (2z^2-x^2-y^2), 0.54627 (x^2-y^2).
struct Harmonic {
  int degree = 0;
  int order = 0;
  bool operator==(const Harmonic&) const = default;
};

inline constexpr int kMaxHarmonicDegree = 8;

/// All harmonics of degree first..last, by degree then order.
[[nodiscard]] std::vector<Harmonic> harmonics_of_degrees(int first, int last);

/// Parses "1,x,y,z", "degree:2", "degree:0-2", "1,degree:2", with names 1 x y z xy yz xz z2 x2-y2; "l:m" names any other.
/// Duplicates are an error, as is an empty list. Throws InvalidInput.
[[nodiscard]] std::vector<Harmonic> parse_harmonics(const std::string& text);

/// The shortest text that parse_harmonics() turns back into `set`.
[[nodiscard]] std::string format_harmonics(const std::vector<Harmonic>& set);

/// Evaluates by the recurrences of the solid harmonics in Cartesian coordinates (no division, exact for polynomials to rounding). O(N L^2).
[[nodiscard]] HarmonicValues evaluate_harmonics(const std::vector<Harmonic>& set, const std::vector<Vec3>& points);

}  // namespace g3r
