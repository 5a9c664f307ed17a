#include "base/degrees.h"
#include "base/disjoint_sets.h"
#include "base/hash.h"
#include "base/number_text.h"
#include "base/pair_key.h"
#include "base/whole_bytes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

namespace g3r {
namespace {

TEST(DisjointSets, AreNamedByTheirSmallestMemberWhateverTheOrder) {
  DisjointSets sets(6), backwards(6);
  const std::vector<std::pair<std::size_t, std::size_t>> joins{{4, 2}, {5, 4}, {1, 3}, {2, 5}};
  for (const auto& [a, b] : joins) sets.join(a, b);
  for (auto join = joins.rbegin(); join != joins.rend(); ++join) backwards.join(join->second, join->first);
  const std::size_t smallest[] = {0, 1, 2, 1, 2, 2};
  for (std::size_t i = 0; i < sets.size(); ++i) {
    EXPECT_EQ(sets.find(i), smallest[i]);
    EXPECT_EQ(backwards.find(i), smallest[i]);
  }
  EXPECT_EQ(sets.count(), 3U);
  EXPECT_EQ(sets.add(), 6U);
  EXPECT_EQ(sets.find(6), 6U);
  EXPECT_EQ(sets.count(), 4U);
}

TEST(Percent, IsWholeButNeverNothingForWhatIsThere) {
  EXPECT_EQ(percent(0.124), "12 %");
  EXPECT_EQ(percent(1), "100 %");
  EXPECT_EQ(percent(0.0034), "0.3 %");
  EXPECT_EQ(percent(1e-6), "under 0.01 %");
  EXPECT_EQ(percent(0), "0 %");
}

TEST(MebibytesNeeded, AreMoreThanALimitThatIsLess) {
  EXPECT_EQ(mebibytes_needed(600 * kMebibyte), 600U);
  EXPECT_EQ(mebibytes_needed(600 * kMebibyte + 1), 601U);
  EXPECT_EQ(mebibytes(600 * kMebibyte + 1), 600U);
}

TEST(WholeBytes, AreNeverMoreThanASizeHolds) {
  EXPECT_EQ(whole_bytes(1024.9), 1024U);
  EXPECT_EQ(whole_bytes(1e30), std::numeric_limits<std::size_t>::max());
  EXPECT_EQ(whole_bytes(std::numeric_limits<double>::infinity()), std::numeric_limits<std::size_t>::max());
  EXPECT_EQ(mebibytes((std::uint64_t{1} << 20) - 1), 0U);
}

TEST(Degrees, OfAQuarterTurnAreNinety) { EXPECT_DOUBLE_EQ(degrees(std::numbers::pi / 2), 90); }

TEST(PairKey, SortsByTheFirstThenTheSecondAndGivesBothBack) {
  constexpr std::uint32_t kLargest = std::numeric_limits<std::uint32_t>::max();
  EXPECT_LT(pair_key(1, kLargest), pair_key(2, 0));
  EXPECT_LT(pair_key(2, 0), pair_key(2, 1));
  EXPECT_EQ(first_of(pair_key(kLargest, 7)), kLargest);
  EXPECT_EQ(second_of(pair_key(kLargest, 7)), 7U);
  EXPECT_EQ(unordered_pair_key(9, 4), unordered_pair_key(4, 9));
  EXPECT_NE(pair_key(9, 4), pair_key(4, 9));
}

// The first output of splitmix64 seeded with 0 is that of its authors.
TEST(Hash, IsThatOfItsAuthorsAndSpreadsNeighbours) {
  EXPECT_EQ(mixed(0), 0xE220A8397B1DCDAFU);
  std::set<std::uint64_t> top;
  for (std::uint64_t i = 0; i < 1024; ++i) top.insert(mixed(i) >> 60U);
  EXPECT_EQ(top.size(), 16U);
}

}  // namespace
}  // namespace g3r
