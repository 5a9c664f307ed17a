// Random numbers that are the same bytes on every machine: integer arithmetic, and floating-point operations that IEEE 754
// rounds exactly. (The standard library's distributions, and log and cos, differ between implementations.)
//
// Sources: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014 (SplitMix64);
// Marsaglia, Bray, "A convenient method for generating normal variables", SIAM Review 6, 1964 (polar method).
#pragma once

#include <cmath>
#include <cstdint>

namespace g3r {

/// A stream of random numbers. Streams of one seed with different `stream` numbers are independent.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(mix(seed + kIncrement * (stream + 1)) ^ mix(seed)) {}

  std::uint64_t bits() { return mix(state_ += kIncrement); }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Standard normal.
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double x = 0, y = 0, s = 0;
    do {
      x = 2 * uniform() - 1;
      y = 2 * uniform() - 1;
      s = x * x + y * y;
    } while (s >= 1 || s == 0);
    const double factor = std::sqrt(-2 * natural_log(s) / s);
    spare_ = y * factor;
    has_spare_ = true;
    return x * factor;
  }

  /// Natural logarithm of a positive normal number, to 4 ulp.
  static double natural_log(double x) {
    int exponent = 0;
    double m = std::frexp(x, &exponent);  // m in [1/2, 1)
    if (m < 0.70710678118654752) {
      m *= 2;
      --exponent;
    }
    // log m = 2 artanh t = 2 (t + t^3/3 + t^5/5 + ...), |t| < 0.1716: the first term left out is below 1e-18.
    const double t = (m - 1) / (m + 1);
    const double t2 = t * t;
    double series = 0;
    for (int k = 21; k >= 1; k -= 2) series = series * t2 + 1.0 / k;
    return exponent * 0.69314718055994531 + 2 * t * series;
  }

 private:
  static constexpr std::uint64_t kIncrement = 0x9e3779b97f4a7c15u;  // 2^64 / golden ratio, odd

  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace g3r
