// What the thinned cloud says at the points of a tile.
#pragma once

#include "tiles/manifest.h"
#include "tiles/records.h"
#include "tiles/tile_cloud.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

namespace g3r::tiles {

/// Of every point of a tile's cloud.
struct CoarseSides {
  /// The winding gradient of the thinned cloud, at kRefinementWidth of its spacing.
  std::vector<Vec3> gradient;
  /// The normal of the thinned cloud's point nearest to it, which is itself where it is one.
  std::vector<CoarseNormal> nearest;
};

/// Reads the thinned cloud. Throws IoError, Cancelled.
[[nodiscard]] CoarseSides coarse_sides(const std::string& folder, const Manifest& m, const TileCloud& cloud,
                                       const std::atomic<bool>* cancel);

}  // namespace g3r::tiles
