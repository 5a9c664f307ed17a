// Triangles whose edges are cut.
#pragma once

#include "mesh/constants.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// Appends triangle t, whose edges 01, 12, 20 are cut at the vertices `cut` (kNone: not cut), in one to four parts.
inline void append_cut(std::array<std::uint32_t, 3> t, std::array<std::uint32_t, 3> cut, std::vector<std::array<std::uint32_t, 3>>& out) {
  const auto cuts = std::count_if(cut.begin(), cut.end(), [](std::uint32_t c) { return c != kNone; });
  if (cuts == 0) {
    out.push_back(t);
    return;
  }
  if (cuts == 3) {
    out.insert(out.end(), {{t[0], cut[0], cut[2]}, {t[1], cut[1], cut[0]}, {t[2], cut[2], cut[1]}, {cut[0], cut[1], cut[2]}});
    return;
  }
  // Turned so that edge 01 is cut and, of two cuts, the other is in edge 12.
  while (cut[0] == kNone || (cuts == 2 && cut[1] == kNone)) {
    std::rotate(t.begin(), t.begin() + 1, t.end());
    std::rotate(cut.begin(), cut.begin() + 1, cut.end());
  }
  if (cuts == 1) {
    out.insert(out.end(), {{t[0], cut[0], t[2]}, {cut[0], t[1], t[2]}});
  } else {
    out.insert(out.end(), {{cut[0], t[1], cut[1]}, {t[0], cut[0], cut[1]}, {t[0], cut[1], t[2]}});
  }
}

}  // namespace g3r::mesh
