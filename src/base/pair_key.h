// Two numbers of 32 bits in one of 64: a key that sorts by the first, then by the second.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace g3r {

inline constexpr auto kHalfKey = static_cast<unsigned>(std::numeric_limits<std::uint32_t>::digits);

constexpr std::uint64_t pair_key(std::uint32_t first, std::uint32_t second) { return std::uint64_t{first} << kHalfKey | second; }
/// The same for both orders of the two.
constexpr std::uint64_t unordered_pair_key(std::uint32_t a, std::uint32_t b) { return pair_key(std::min(a, b), std::max(a, b)); }
constexpr std::uint32_t first_of(std::uint64_t key) { return static_cast<std::uint32_t>(key >> kHalfKey); }
constexpr std::uint32_t second_of(std::uint64_t key) { return static_cast<std::uint32_t>(key); }

}  // namespace g3r
