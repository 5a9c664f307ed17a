// A table of pairs beside the ordered map of the standard library, over random additions and removals.
#include "orient/pair_sums.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <utility>

namespace g3r {
namespace {

TEST(PairSums, HoldsWhatAMapHolds) {
  constexpr std::uint32_t kNodes = 40;  // few, so that pairs collide and come back
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    shapes::Random random(seed);
    PairSums sums(kNodes * (kNodes - 1) / 2);
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> expected;
    for (int step = 0; step < 5000; ++step) {
      const auto a = static_cast<std::uint32_t>(random.uniform() * kNodes);
      const auto b = static_cast<std::uint32_t>(random.uniform() * kNodes);
      if (a == b) continue;
      const std::pair<std::uint32_t, std::uint32_t> pair = std::minmax(a, b);
      double* sum = sums.find(a, b);
      ASSERT_EQ(sum != nullptr, expected.contains(pair));
      if (sum == nullptr) {
        sums.add(a, b, expected[pair] = random.uniform());
      } else if (random.uniform() < 0.5) {
        EXPECT_EQ(*sum, expected[pair]);
        *sum += 1;
        expected[pair] += 1;
      } else {
        sums.remove(b, a);
        expected.erase(pair);
      }
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> found;
    sums.for_each([&](std::uint32_t a, std::uint32_t b, double sum) { found[{a, b}] = sum; });
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace g3r
