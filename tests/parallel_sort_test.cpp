// Sorting in threads puts items where sorting in one does, whatever their order was.
#include "cpu/parallel_sort.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <vector>

namespace g3r {
namespace {

// Sorted in no round, in one and in several.
constexpr std::size_t kSizes[] = {0, 1, 2, 4096, 4097, 100000, 1000000};

void expect_sorted(std::vector<int> items) {
  std::vector<int> expected = items;
  std::sort(expected.begin(), expected.end());
  parallel::sort(items.begin(), items.end(), std::less<>());
  EXPECT_EQ(items, expected);
}

TEST(ParallelSort, AnyOrderIsSorted) {
  shapes::Random random(5);
  for (const std::size_t size : kSizes) {
    std::vector<int> items(size);
    std::iota(items.begin(), items.end(), 0);
    expect_sorted(items);
    std::reverse(items.begin(), items.end());
    expect_sorted(items);
    for (int& item : items) item = static_cast<int>(random.uniform(0, 1e9));
    expect_sorted(items);
  }
}

// Ranges that no round divides.
TEST(ParallelSort, EqualItemsAreSorted) {
  std::vector<int> items(100000, 7);
  items.back() = 6;
  expect_sorted(items);
}

// Organ pipes: every sample of a range has the same few of its values.
TEST(ParallelSort, ItemsThatRiseAndFallAreSorted) {
  std::vector<int> items(100000);
  for (std::size_t i = 0; i < items.size(); ++i) items[i] = static_cast<int>(std::min(i, items.size() - i));
  expect_sorted(items);
}

}  // namespace
}  // namespace g3r
