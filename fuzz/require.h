// What the fuzz targets share: the check whose failure is a finding, and the memory law of the program.
#pragma once

#include <cstddef>
#include <cstdio>

#include "counting_allocator.h"

namespace g3r::fuzz {

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "violated: %s\n", what);
  __builtin_trap();
}

/// At its end allocations must have stayed within a limit: 64 MiB + 16 x the size of the input, or the one given.
class MemoryLaw {
 public:
  explicit MemoryLaw(std::size_t input_size) : MemoryLaw(16 * input_size, std::size_t{64} << 20) {}
  MemoryLaw(std::size_t proportional, std::size_t constant) : limit_(proportional + constant), before_(allocator::live) {
    allocator::reset_peak();
  }
  ~MemoryLaw() { require(allocator::peak - before_ <= limit_, "the memory law"); }
  MemoryLaw(const MemoryLaw&) = delete;
  MemoryLaw& operator=(const MemoryLaw&) = delete;

 private:
  std::size_t limit_;
  std::size_t before_;
};

}  // namespace g3r::fuzz
