// Sorting in threads, where there are any (cpu/parallel.h).
#pragma once

#ifdef G3R_SERIAL
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

namespace g3r::parallel {

/// Sorts by a strict total order (no two items equal), so the result is unique. O(N log N), in place.
template <class Iterator, class Less>
void sort(Iterator begin, Iterator end, const Less& less) {
#ifdef G3R_SERIAL
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace g3r::parallel
