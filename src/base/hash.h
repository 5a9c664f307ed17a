// Well mixed bits of whole numbers: the same for every machine and library, which std::hash is not.
#pragma once

#include <cstdint>

namespace g3r {

/// 2^64 over the golden ratio, odd: multiples of it fall far apart, so that the top bits of the products of numbers next to each other
/// differ (Fibonacci hashing: Knuth, "The art of computer programming", 6.4).
inline constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15U;

/// A permutation of the numbers: splitmix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
constexpr std::uint64_t mixed(std::uint64_t x) {
  x += kGolden;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

}  // namespace g3r
