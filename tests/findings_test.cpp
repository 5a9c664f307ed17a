// Warnings about the sampling and the topology: on what they are for, and not on ordinary clouds.
#include "mesh/findings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "cloud/neighbours.h"
#include "cloud/spacing.h"
#include "field_shapes.h"
#include "shapes.h"

namespace g3r {
namespace {

using testing::cube_sample;
using testing::OrientedSample;
using testing::sphere_sample;

std::vector<std::string> warnings_of(const OrientedSample& sample, double noise = 0) {
  CanonicalCloud cloud;
  cloud.set = PointSet(sample.points);
  Stats stats;
  stats.noise = noise;
  warn_of_sampling(cloud, sample.normals, stats);
  EXPECT_FALSE(stats.doubtful);
  return stats.warnings;
}

bool one_begins(const std::vector<std::string>& warnings, const std::string& words) {
  return warnings.size() == 1 && warnings.front().rfind(words, 0) == 0;
}

OrientedSample rounded(OrientedSample sample, double step, std::size_t first_axis) {
  for (Vec3& p : sample.points) {
    for (std::size_t a = first_axis; a < 3; ++a) p[a] = step * std::round(p[a] / step);
  }
  return sample;
}

// A slab for each height, normals up and down.
OrientedSample slats(std::size_t count) {
  OrientedSample out;
  for (std::size_t i = 0; i < count; ++i) {
    const OrientedSample face = cube_sample(6, 1, i + 1);
    const std::size_t level = i % 10;
    out.points.push_back({face.points[1][0], face.points[0][1], 0.02 * static_cast<double>(level)});
    out.normals.push_back({0, 0, level % 2 == 0 ? -1.0 : 1.0});
  }
  return out;
}

TEST(Findings, LinesAreNamed) {
  OrientedSample rings;
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 200; ++j) {
      const double v = 2 * M_PI * j / 200;
      rings.points.push_back({std::cos(v), std::sin(v), 0.4 * i});
      rings.normals.push_back({std::cos(v), std::sin(v), 0});
    }
  }
  EXPECT_TRUE(one_begins(warnings_of(rings), "sampled in lines: 100 %"));
}

TEST(Findings, RoundedCoordinatesAreNamedWithTheirAxes) {
  const OrientedSample sphere = sphere_sample(6000, 1, 1);
  EXPECT_TRUE(one_begins(warnings_of(rounded(sphere, 0.02, 0)), "rounded coordinates: along x, y, z they come in steps of about 0.02"));
  EXPECT_TRUE(one_begins(warnings_of(rounded(sphere, 0.02, 2)), "rounded coordinates: along z they come in steps of about 0.02"));
  EXPECT_TRUE(warnings_of(rounded(sphere, 0.001, 0)).empty());
}

// What the solve has smoothed over already needs no advice.
TEST(Findings, RoundingThatCountsAsNoiseNeedsNoAdvice) {
  const OrientedSample voxels = rounded(sphere_sample(6000, 1, 1), 0.02, 0);
  EXPECT_NE(warnings_of(voxels, 0.001).front().find("smooth over them with a noise of 0.0058 or more"), std::string::npos);
  EXPECT_NE(warnings_of(voxels, 0.006).front().find("spacings), which are smoothed over as noise of 0.006"), std::string::npos);
}

// A plate whose sides are not distinguished looks like terraces; its rim shows that it is none.
TEST(Findings, ThinPlatesAreNotRounded) {
  shapes::Random random(2);
  OrientedSample plate;
  for (int i = 0; i < 6000; ++i) {
    const bool at_rim = i % 20 == 0;
    const double height = 0.02;
    plate.points.push_back({at_rim ? 1 : random.uniform(-1, 1), random.uniform(-1, 1),
                            at_rim                   ? random.uniform(0, height)
                            : random.uniform() < 0.5 ? 0
                                                     : height});
    plate.normals.push_back(at_rim ? Vec3{1, 0, 0} : Vec3{0, 0, 1});
  }
  EXPECT_EQ(warnings_of(plate), std::vector<std::string>{});
}

TEST(Findings, OrdinaryCloudsAreNotAccused) {
  EXPECT_TRUE(warnings_of(sphere_sample(6000, 1, 1)).empty());
  EXPECT_TRUE(warnings_of(cube_sample(6000, 1, 1)).empty());
  EXPECT_EQ(warnings_of(slats(6000)), std::vector<std::string>{});
  OrientedSample grid;  // on a plate: all coordinates are on a lattice, and none is in terraces
  for (int i = 0; i < 5000; ++i) {
    const bool top = i % 2 != 0;
    grid.points.push_back({2.0 * (i / 2 % 50), 2.0 * (i / 100), top ? 1.0 : 0.0});
    grid.normals.push_back({0, 0, top ? 1.0 : -1.0});
  }
  EXPECT_TRUE(warnings_of(grid).empty());
  EXPECT_TRUE(warnings_of(sphere_sample(20, 1, 1)).empty());
}

Stats judged(std::size_t points, long genus, std::size_t components) {
  Stats stats;
  stats.used = points;
  MeshCheck check;
  check.genus = genus;
  check.components = components;
  warn_of_topology(check, stats);
  return stats;
}

TEST(Findings, HandlesAndPartsNeedPoints) {
  EXPECT_TRUE(one_begins(judged(5000, 44, 1).warnings, "genus 44: one handle for every 113 points"));
  EXPECT_TRUE(judged(5000, 44, 1).doubtful);
  EXPECT_FALSE(judged(5000, 32, 8).doubtful);  // slats with 32 true handles
  EXPECT_FALSE(judged(500, 9, 9).doubtful);
  EXPECT_FALSE(judged(5000, 0, 26).doubtful);  // the bones of a foot
  EXPECT_TRUE(one_begins(judged(5000, 0, 157).warnings, "157 parts: one for every 31 points"));
  EXPECT_TRUE(judged(5000, 0, 157).doubtful);
  EXPECT_TRUE(judged(5000, -1, 1).warnings.empty());
}

}  // namespace
}  // namespace g3r
