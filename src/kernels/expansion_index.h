// Where the coefficients of an expansion in real solid harmonics are (expansions/expansions.h): the order of every array that holds some.
#pragma once

#include <cstddef>

namespace g3r {

inline constexpr int kMaxExpansionOrder = 18;  // (2p)! / 4^(2p) must stay in range of the coefficients' products

/// Number of coefficients of order p: (p + 1)^2.
constexpr std::size_t coefficient_count(int order) { return static_cast<std::size_t>(order + 1) * static_cast<std::size_t>(order + 1); }
/// Index of Re R_l^m (m >= 0) and of Im R_l^m (m > 0) in the real basis.
constexpr std::size_t real_index(int l, int m) { return static_cast<std::size_t>(l * l + (m == 0 ? 0 : 2 * m - 1)); }
constexpr std::size_t imaginary_index(int l, int m) { return static_cast<std::size_t>(l * l + 2 * m); }

}  // namespace g3r
