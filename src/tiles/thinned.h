// The thinned cloud, with what its solve has found.
#pragma once

#include "field/oriented_cloud.h"
#include "tiles/manifest.h"
#include "tiles/records.h"

#include <g3r/points.h>

#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

/// R-th points in Morton order, and what was found of each.
struct Thinned {
  std::vector<Vec3> points;
  std::vector<CoarseNormal> found;
};

/// Throws InvalidInput where a record is none that a plan writes, IoError.
[[nodiscard]] Thinned read_thinned(const std::string& folder, const Manifest& manifest);

/// With the areas that the plan has found. Throws InvalidInput where no point has one.
[[nodiscard]] OrientedCloud with_areas(const Thinned& thinned, const Manifest& manifest);

/// `open` without the points that have one of another kind among their nearest 16: where the thinned cloud takes a few points amid closed
/// ones for open, or the other way round, the tile sees more. Of N points. O(N log N).
[[nodiscard]] std::vector<std::uint8_t> open_all_around(const std::vector<Vec3>& points, const std::vector<std::uint8_t>& open);

}  // namespace g3r::tiles
