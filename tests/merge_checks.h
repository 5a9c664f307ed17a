// What tiles write of their inputs, and that it is what write_cloud() writes.
#pragma once

#include "io/laz.h"
#include "io/source.h"
#include "io_samples.h"
#include "stream_checks.h"
#include "tiles/point_writer.h"

#include <g3r/io.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace g3r::merge_checks {

/// The inputs as tiles::merge() writes them to `output`.
inline void merge_as_tiles(const std::vector<std::string>& inputs, const std::vector<Vec3>& normals, const std::vector<float>& confidence,
                           const std::string& output) {
  tiles::Manifest manifest;
  manifest.bounds = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  for (const std::string& input : inputs) {
    const std::vector<Vec3> points = stream_checks::streamed(input).points;
    manifest.inputs.push_back({input, 0, points.size()});
    manifest.points += points.size();
    for (const Vec3& p : points) {
      for (std::size_t a = 0; a < 3; ++a) {
        manifest.bounds.low[a] = std::min(manifest.bounds.low[a], p[a]);
        manifest.bounds.high[a] = std::max(manifest.bounds.high[a], p[a]);
      }
    }
  }
  const Monitor monitor;
  Stages stages(monitor);
  tiles::PointWriter writer(output, manifest, stages);
  std::size_t at = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto stream = io::open_points(inputs[i], true);
    std::vector<Vec3> points;
    std::string records;
    const std::size_t most = normals.size() > 1000 ? 1000 : stream_checks::kAtOnce;
    writer.begin(*stream);
    for (stream->next(most, points, &records); !points.empty(); stream->next(most, points, &records)) {
      const auto from = static_cast<std::ptrdiff_t>(at);
      const auto to = static_cast<std::ptrdiff_t>(at + points.size());
      writer.write(i, points, records, {normals.begin() + from, normals.begin() + to},
                   {confidence.begin() + from, confidence.begin() + to});
      at += points.size();
    }
    writer.end(*stream);
  }
  writer.commit();
}

/// `path` as read_cloud() takes it, which stands for the inputs. Of PLY, LAS and LAZ.
inline void expect_what_write_cloud_writes(const std::string& path, const std::vector<std::string>& inputs) {
  const Cloud whole = read_cloud(path);
  std::vector<Vec3> normals;
  std::vector<float> confidence;
  for (std::size_t i = 0; i < whole.positions.size(); ++i) {
    normals.push_back({std::cos(static_cast<double>(i)), std::sin(static_cast<double>(i)), 0});
    confidence.push_back(static_cast<float>(i % 7) / 7);
  }
  const samples::Folder folder;
  for (const char* extension : {"ply", "las", "laz"}) {
    if (extension == std::string("laz") && !io::laz_is_compiled()) continue;
    const std::string expected = folder.path(std::string("whole.") + extension);
    const std::string found = folder.path(std::string("tiles.") + extension);
    write_cloud(expected, whole, &normals, &confidence);
    merge_as_tiles(inputs, normals, confidence, found);
    EXPECT_TRUE(samples::slurp(expected) == samples::slurp(found)) << path << " as " << extension;
  }
}

}  // namespace g3r::merge_checks
