#include "cloud/chance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace g3r {

double normal_distribution(double x) { return std::erfc(-x / std::numbers::sqrt2) / 2; }

double share_of_ball(double height) {
  const double t = std::min(height, 1.0);
  return (3 * t - t * t * t) / 2;
}

std::vector<double> chances_of_as_many(std::size_t n, double share) {
  std::vector<double> chances(n + 1, 1);
  double tail = 0, logarithm = static_cast<double>(n) * std::log(share);  // of the term of all n, which may be too small for a number
  for (std::size_t k = n; k > 0; --k) {
    chances[k] = tail += std::exp(logarithm);
    logarithm += std::log(static_cast<double>(k) / static_cast<double>(n - k + 1) * (1 - share) / share);
  }
  return chances;
}

std::size_t proving_number(std::size_t n, double share, double tests) {
  const std::vector<double> chances = chances_of_as_many(n, share);
  const auto first = std::find_if(chances.begin(), chances.end(), [&](double chance) { return tests * chance <= kFalseAlarms; });
  return static_cast<std::size_t>(first - chances.begin());
}

}  // namespace g3r
