// The cells of an EPT data set, as the files of its hierarchy name them. Source: entwine.io, "Entwine Point Tile".
#pragma once

#include <g3r/io.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace g3r::io {

using EptKey = std::array<std::uint32_t, 4>;  ///< level, x, y, z

/// A cell that has points of its own.
struct EptCell {
  EptKey key;
  std::uint64_t points;
  /// "3-1-0-7": of its file.
  [[nodiscard]] std::string name() const;
};

/// The cells that have points, of the levels and the box that are asked for, ascending. `bounds`: low and high corner of the octree's cube.
/// Throws InvalidInput, IoError.
std::vector<EptCell> find_ept_cells(const std::filesystem::path& folder, const std::array<double, 6>& bounds, const ReadOptions& options);

}  // namespace g3r::io
