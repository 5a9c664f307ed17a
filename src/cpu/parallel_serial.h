// Loops on the calling thread: the back end of cpu/parallel.h without threads, for machines that have none (browsers). The same blocks in
// the same order of addition as with threads, and therefore the same bytes.
#pragma once

#include <g3r/error.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <utility>

namespace g3r::parallel {

inline int thread_count(int /*threads*/) { return 1; }

template <class Work>
auto with_threads(int /*threads*/, Work&& work) {
  return std::forward<Work>(work)();
}

template <class Body>
void for_each(std::size_t count, const Body& body, const std::atomic<bool>* cancel = nullptr) {
  for (std::size_t i = 0; i < count; ++i) {
    if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) throw Cancelled();
    body(i);
  }
}

template <class Iterator, class Less>
void sort(Iterator begin, Iterator end, const Less& less) {
  std::sort(begin, end, less);
}

}  // namespace g3r::parallel
