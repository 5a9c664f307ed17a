// Plans of memory, where a product may be more than a size holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace g3r {

inline constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20U;
/// Whole mebibytes in so many bytes: of a limit.
inline std::uint64_t mebibytes(std::uint64_t bytes) { return bytes / kMebibyte; }
/// Whole mebibytes that so many bytes need: more than a limit that is less.
inline std::uint64_t mebibytes_needed(std::uint64_t bytes) { return bytes / kMebibyte + (bytes % kMebibyte != 0 ? 1 : 0); }

/// The number of bytes as a size, the largest one where it is more: sizes have 32 bits in a browser. Not negative.
inline std::size_t whole_bytes(double bytes) {
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  return bytes < static_cast<double>(kMost) ? static_cast<std::size_t>(bytes) : kMost;
}

}  // namespace g3r
