// The memory that a worker takes, by the number of points that it solves for.
#pragma once

#include <cstddef>
#include <cstdint>

namespace g3r::tiles {

/// Bytes of a solve in core of so many points without noise, or of fewer where those take more.
[[nodiscard]] std::size_t in_core(std::uint64_t points);

/// Bytes of a worker with a tile of so many points, those around it included.
[[nodiscard]] std::size_t memory_for(std::uint64_t points);

/// The most points for which memory_for() is no more than these bytes.
[[nodiscard]] std::uint64_t points_for(std::size_t memory);

}  // namespace g3r::tiles
