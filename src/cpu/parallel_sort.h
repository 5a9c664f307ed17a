// Sorting in threads, where there are any (cpu/parallel.h).
#pragma once

#include "cpu/parallel.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

namespace g3r::parallel {

/// Sorts by a strict total order (no two items equal), so the result is unique. O(N log N), in place.
///
/// Quicksort, all ranges of a round at once, until there are enough of them, or they are short, for a thread to sort each.
template <class Iterator, class Less>
void sort(Iterator begin, Iterator end, const Less& less) {
  constexpr int kRounds = 10;              // up to 1024 ranges: some for each thread, whatever their lengths
  constexpr std::ptrdiff_t kAlone = 4096;  // items that are sorted before other threads would have begun
  constexpr std::ptrdiff_t kSample = 9;
  if (std::is_sorted(begin, end, less)) return;
  using Range = std::pair<Iterator, Iterator>;
  const auto is_long = [](const Range& range) { return range.second - range.first > kAlone; };
  std::vector<Range> ranges{{begin, end}};
  for (int round = 0; round < kRounds && std::any_of(ranges.begin(), ranges.end(), is_long); ++round) {
    const std::size_t count = ranges.size();
    ranges.resize(2 * count, {end, end});
    for_each(count, [&](std::size_t r) {  // what is not less than the median of some goes to the second half of the ranges
      if (!is_long(ranges[r])) return;
      const auto [first, last] = ranges[r];
      std::vector<typename std::iterator_traits<Iterator>::value_type> sample;
      for (std::ptrdiff_t k = 0; k < kSample; ++k) sample.push_back(first[(last - first) / kSample * k]);
      std::sort(sample.begin(), sample.end(), less);
      const auto& pivot = sample[kSample / 2];
      const Iterator middle = std::partition(first, last, [&](const auto& item) { return less(item, pivot); });
      ranges[r].second = middle;
      ranges[count + r] = {middle, last};
    });
  }
  for_each(ranges.size(), [&](std::size_t r) { std::sort(ranges[r].first, ranges[r].second, less); });
}

}  // namespace g3r::parallel
