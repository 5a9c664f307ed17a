// What a stream of points returns, and that it is what the reader of the whole file gives.
#pragma once

#include "io/point_stream.h"

#include <g3r/io.h>

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

namespace g3r::stream_checks {

inline constexpr std::size_t kAtOnce = 5;  // points, so that streams are read in many pieces

struct Streamed {
  std::vector<Vec3> points;
  std::string records;
  io::Element properties;
  Scalar scalar = Scalar::kFloat64;
};

inline Streamed streamed(const std::string& path) {
  const auto stream = io::open_points(path, true);
  Streamed all{{}, {}, stream->table().points(), stream->scalar()};
  EXPECT_EQ(stream->left(), all.properties.count) << path;
  EXPECT_TRUE(all.properties.data.empty()) << path;
  std::vector<Vec3> points;
  std::string records;
  for (stream->next(kAtOnce, points, &records); !points.empty(); stream->next(kAtOnce, points, &records)) {
    EXPECT_LE(points.size(), kAtOnce) << path;
    all.points.insert(all.points.end(), points.begin(), points.end());
    all.records += records;
  }
  EXPECT_EQ(stream->left(), 0U) << path;
  return all;
}

/// What read_cloud() refuses the file with, "" if it does not.
inline std::string refusal_of_read_cloud(const std::string& path) {
  try {
    (void)read_cloud(path);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

inline bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  if (a.empty() || b.empty()) return a.size() == b.size();  // they may have no address
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

inline void expect_what_read_cloud_gives(const std::string& path) {
  const Cloud whole = read_cloud(path);
  const Streamed stream = streamed(path);
  EXPECT_TRUE(same_bits(stream.points, whole.positions)) << path;
  EXPECT_EQ(stream.scalar, whole.scalar) << path;
  if (whole.attributes == nullptr) return;
  const io::Element& points = whole.attributes->points();
  EXPECT_EQ(stream.records, points.data) << path;
  ASSERT_EQ(stream.properties.properties.size(), points.properties.size()) << path;
  for (std::size_t i = 0; i < points.properties.size(); ++i) {
    EXPECT_EQ(stream.properties.properties[i].name, points.properties[i].name) << path;
    EXPECT_EQ(stream.properties.properties[i].type, points.properties[i].type) << path;
  }
}

}  // namespace g3r::stream_checks
