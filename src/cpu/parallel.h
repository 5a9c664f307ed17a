// All loops that may run in threads. Every loop is over blocks whose bounds do not depend on the number of threads, and reductions add
// block results in block order, so results are the same bytes for any number of threads, and for none.
//
// A back end has, in namespace g3r::parallel:
//   thread_count(threads)               number of threads a request gets: 0 asks for all cores. Never more than there are cores
//   with_threads(threads, work)         runs work() with at most so many threads and returns what it returns
//   for_each(count, body[, cancel])     body(i) for i in [0, count), each call independent of the others; `cancel` (may be null) stops the
//                                       loop with Cancelled
//   sort(begin, end, less)              sorts by a strict total order (no two items equal), so the result is unique
// There are two: oneTBB, and none where CMake's G3R_THREADS is off.
#pragma once

#ifdef G3R_SERIAL
#include "cpu/parallel_serial.h"
#else
#include "cpu/parallel_tbb.h"
#endif

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

namespace g3r::parallel {

/// Items per block: of loops that do little for each, and of those that search, fit or draw. Sums over blocks are added in their order, so
/// other numbers change last digits.
inline constexpr std::size_t kBlock = 1024;
inline constexpr std::size_t kSmallBlock = 256;

/// body(begin, end) over [0, count) cut into blocks of `block` items.
template <class Body>
void for_blocks(std::size_t count, std::size_t block, const Body& body, const std::atomic<bool>* cancel = nullptr) {
  for_each((count + block - 1) / block, [&](std::size_t b) { body(b * block, std::min(count, (b + 1) * block)); }, cancel);
}

/// body(i) for i in [0, count), in blocks: for bodies that do little.
template <class Body>
void for_all(std::size_t count, const Body& body) {
  for_blocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Sum of term(begin, end) over blocks, added in block order.
template <class T, class Term>
T sum_blocks(std::size_t count, std::size_t block, T zero, const Term& term) {
  std::vector<T> partial((count + block - 1) / block, zero);
  for_blocks(count, block, [&](std::size_t begin, std::size_t end) { partial[begin / block] = term(begin, end); });
  T total = zero;
  for (const T& part : partial) total += part;
  return total;
}

}  // namespace g3r::parallel
