#include "tiles/survey.h"

#include "base/platform.h"
#include "base/vector.h"
#include "mesh/field_points.h"
#include "mesh/used_vertices.h"
#include "tiles/inputs.h"
#include "tiles/point_hash.h"
#include "tiles/spacing_sample.h"

#include <g3r/io.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

namespace g3r::tiles {
namespace {

constexpr std::size_t kMostWarnings = 8;  // of all files together

// The points fill the frame as far as may be with cells of the mesh, halves of halves of the frame, of the size that they have in core.
double scale_for(double longest_side, double spacing) {
  const double scale = kLongestSide / longest_side;
  const double halvings = std::log2(2 / (mesh::kFinestCell * spacing * scale));
  return spacing > 0 && std::isfinite(halvings) ? scale * std::exp2(halvings - std::ceil(halvings)) : scale;
}

// Around all points.
Frame frame_of(const Box& bounds, double spacing) {
  Frame frame;
  double side = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(std::max(-bounds.low[a], bounds.high[a]) <= kLargestCoordinate)) {
      throw InvalidInput("coordinates beyond 1e50 are no lengths that can be worked with");
    }
    side = std::max(side, bounds.high[a] - bounds.low[a]);
    frame.centre[a] = bounds.low[a] + (bounds.high[a] - bounds.low[a]) / 2;
  }
  if (!(side > 1 / kLargestCoordinate)) throw InvalidInput("all points are at one place");
  frame.scale = scale_for(side, spacing);
  return frame;
}

void require_some_finite(const std::vector<Input>& inputs, const std::vector<std::uint64_t>& non_finite) {
  for (std::size_t f = 0; f < inputs.size(); ++f) {
    if (non_finite[f] == 0 || non_finite[f] < inputs[f].points) continue;
    throw InvalidInput(escape_text(inputs[f].path) + ": from the first to the last of its " + std::to_string(non_finite[f]) +
                       " points no coordinates are finite; get the file again, or leave it out");
  }
}

}  // namespace

Manifest survey(const std::vector<std::string>& files, int threads, Stages& stages) {
  stages.begin("read");
  Manifest m;
  for (const std::string& file : files) {
    std::error_code ignored;  // of a file that is gone again; reading it says so
    m.inputs.push_back({file, std::filesystem::file_size(platform::path_of(file), ignored)});
  }
  std::vector<std::uint64_t> non_finite(files.size());
  SpacingSample sample;
  vector::Box box;
  std::size_t more_warnings = 0;
  const auto begin = [&](std::size_t file, const io::PointStream& stream) {
    for (const std::string& warning : stream.warnings()) {
      if (m.warnings.size() < kMostWarnings) {
        m.warnings.push_back(escape_text(files[file]) + ": " + escape_text(warning));
      } else {
        ++more_warnings;
      }
    }
  };
  for_all_points(
      files, {.threads = threads, .cancel = stages.cancel()}, begin, [&](double share) { stages.progress(share); },
      [&](std::size_t file, const Vec3& p) {
        ++m.points;
        ++m.inputs[file].points;
        m.inputs[file].hash = point_hash(m.inputs[file].hash, p);
        if (!vector::is_finite(p)) {
          ++m.non_finite;
          ++non_finite[file];
          return;
        }
        sample.add(p);
        box.extend(p);
      });
  require_some_finite(m.inputs, non_finite);
  if (m.sorted() < kFewestPoints) {
    throw InvalidInput(std::to_string(m.sorted()) + " points are too few for tiles: expected at least " + std::to_string(kFewestPoints) +
                       "; g3r orient takes them as they are");
  }
  m.bounds = {box.low, box.high};
  m.frame = frame_of(m.bounds, sample.spacing());
  if (more_warnings > 0) m.warnings.push_back("and " + std::to_string(more_warnings) + " more warnings about these files");
  if (m.non_finite > 0) m.warnings.push_back(std::to_string(m.non_finite) + " points with a non-finite coordinate were left out");
  return m;
}

}  // namespace g3r::tiles
