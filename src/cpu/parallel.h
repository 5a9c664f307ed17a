// All loops that may run in threads. Every loop is over blocks whose bounds do not depend on the number of threads, and reductions add
// block results in block order, so results are the same bytes for any number of threads, and for none.
//
// There are two back ends: oneTBB (parallel_tbb.cpp), and none where CMake's G3R_THREADS is off (parallel_serial.cpp). Neither is named
// here: loops hand their bodies over by reference, so that the library is compiled once and not for every body.
#pragma once

#include <g3r/error.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace g3r::parallel {

/// A reference to a function object, which outlives it.
template <class... Arguments>
class FunctionRef {
 public:
  template <class Function>
  FunctionRef(const Function& function)  // NOLINT(google-explicit-constructor): stands for the function
      : function_(&function), call_([](const void* of, Arguments... arguments) { (*static_cast<const Function*>(of))(arguments...); }) {}
  void operator()(Arguments... arguments) const { call_(function_, arguments...); }

 private:
  const void* function_;
  void (*call_)(const void*, Arguments...);
};

// What a back end has.

/// Number of threads a request gets: 0 asks for all cores. Never more than there are cores.
int thread_count(int threads);
/// Runs work() with at most so many threads.
void run_with_threads(int threads, FunctionRef<> work);
/// body(begin, end) for parts of [0, count) that together are all of it, each call independent of the others.
void for_ranges(std::size_t count, FunctionRef<std::size_t, std::size_t> body);

// What all have.

/// Items per block: of loops that do little for each, and of those that search, fit or draw. Sums over blocks are added in their order, so
/// other numbers change last digits.
inline constexpr std::size_t kBlock = 1024;
inline constexpr std::size_t kSmallBlock = 256;

/// Runs work() with at most so many threads and returns what it returns.
template <class Work>
auto with_threads(int threads, Work&& work) {
  using Result = std::invoke_result_t<Work>;
  if constexpr (std::is_void_v<Result>) {
    run_with_threads(threads, [&] { work(); });
  } else {
    std::optional<Result> result;
    run_with_threads(threads, [&] { result.emplace(work()); });
    return std::move(*result);
  }
}

/// body(i) for i in [0, count), each call independent of the others; `cancel` (may be null) stops the loop with Cancelled.
template <class Body>
void for_each(std::size_t count, const Body& body, const std::atomic<bool>* cancel = nullptr) {
  for_ranges(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) throw Cancelled();
      body(i);
    }
  });
}

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
