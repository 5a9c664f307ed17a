// What decides between one piece and tiles, for programs that choose by themselves.
#pragma once

#include <g3r/tiles.h>

#include <cstddef>
#include <string>
#include <vector>

namespace g3r::tiles {

/// needs_tiles(), with progress. Throws Cancelled too.
[[nodiscard]] bool exceed(const std::vector<std::string>& inputs, std::size_t limit, bool mesh, const Monitor& monitor);

}  // namespace g3r::tiles
