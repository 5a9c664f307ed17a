#include "tiles/thinned.h"

#include "cloud/neighbours.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"

#include <g3r/io.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace g3r::tiles {
namespace {

constexpr float kLongest = 1.001F;  // of a unit normal in float

bool is_sound(const CoarseNormal& c) {
  const bool is_direction = std::all_of(c.normal.begin(), c.normal.end(), [](float x) { return std::abs(x) <= kLongest; });
  return is_direction && c.confidence >= 0 && c.confidence <= 1 && c.area >= 0 && std::isfinite(c.area) && c.open <= 1;
}

}  // namespace

Thinned read_thinned(const std::string& folder, const Manifest& manifest) {
  const RecordFile<Record> places(points_path(folder, manifest.stride));
  const RecordFile<CoarseNormal> found(coarse_path(folder));
  std::vector<Record> records;
  Thinned thinned;
  places.append(0, manifest.coarse_points, records);
  found.append(0, manifest.coarse_points, thinned.found);
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (!is_sound(thinned.found[k])) {
      throw InvalidInput(escape_text(coarse_path(folder)) + ": damaged at record " + std::to_string(k) +
                         "; remove the folder, and make the plan anew");
    }
    thinned.points.push_back(records[k].point);
  }
  return thinned;
}

OrientedCloud with_areas(const Thinned& thinned, const Manifest& manifest) {
  const std::size_t count = thinned.points.size();
  std::vector<Vec3> normals(count);
  std::vector<double> areas(count);
  for (std::size_t i = 0; i < count; ++i) {
    const CoarseNormal& found = thinned.found[i];
    for (std::size_t a = 0; a < 3; ++a) normals[i][a] = found.normal[a];
    areas[i] = found.area * manifest.coarse_spacing * manifest.coarse_spacing;
  }
  return oriented_cloud(thinned.points, normals, areas, manifest.coarse_spacing);
}

std::vector<std::uint8_t> open_all_around(const std::vector<Vec3>& points, const std::vector<std::uint8_t>& open) {
  std::vector<std::uint8_t> around = open;
  if (points.size() < kSpacingNeighbours || std::count(open.begin(), open.end(), std::uint8_t{0}) == 0) return around;
  const std::vector<std::uint32_t> near = Neighbours(points).of_all(kSpacingNeighbours);
  parallel::for_all(points.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < kSpacingNeighbours; ++k) around[i] &= open[near[i * kSpacingNeighbours + k]];
  });
  return around;
}

}  // namespace g3r::tiles
