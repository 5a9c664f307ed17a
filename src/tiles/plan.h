// What decides between one piece and tiles, for programs that choose by themselves.
#pragma once

#include <g3r/tiles.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

/// The limit where none is given: three quarters of the memory that is free, in bytes; 0 where the system does not say.
[[nodiscard]] std::size_t default_limit();

/// Whether so many points in core, with `mesh` up to a mesh, take more than the limit (0: none) and than tiles can do with.
[[nodiscard]] bool is_beyond(std::size_t limit, std::uint64_t points, bool mesh);

/// Whether plan_tiles() would go on with what is in the folder, as far as names and sizes of the inputs tell. Throws IoError.
[[nodiscard]] bool holds_plan_of(const std::string& folder, const std::vector<std::string>& inputs, const TileOptions& options);

/// needs_tiles(), with progress. Throws Cancelled too.
[[nodiscard]] bool exceed(const std::vector<std::string>& inputs, std::size_t limit, bool mesh, const Monitor& monitor);

}  // namespace g3r::tiles
