// A table under an object is found by the field beside it, though the field of both is at rest on the whole.
#include "orient/restless.h"

#include "cloud/canonical_cloud.h"
#include "orient/certified_sides.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

// A ball and an annulus around its lower part, as many points per area, the table facing up or down; canonical.
struct OnTable {
  PointSet set;
  std::vector<Vec3> normals;
  std::vector<std::uint8_t> is_table;
  double top = 0;  // from where on a point is on the upper third of the ball
};

OnTable on_table(double table_radius, double faces) {
  const std::size_t count = 8000;
  const double height = -0.5;  // of the table
  const double inner = std::sqrt(0.9 * 0.9 - height * height);
  shapes::Surface all;
  const shapes::Surface ball = shapes::sphere(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (table_radius > 0 && ball.points[i][2] < height) continue;
    all.points.push_back(ball.points[i]);
    all.normals.push_back(ball.normals[i]);
  }
  const std::size_t of_ball = all.points.size();
  shapes::Random random(3);
  const double h = std::sqrt(ball.areas[0]);
  for (double x = -table_radius; x < table_radius; x += h) {
    for (double y = -table_radius; y < table_radius; y += h) {
      const Vec3 p{x + random.uniform(-0.3, 0.3) * h, y + random.uniform(-0.3, 0.3) * h, height};
      const double r = std::hypot(p[0], p[1]);
      if (r < inner || r > table_radius) continue;
      all.points.push_back(p);
      all.normals.push_back({0, 0, faces});
    }
  }
  const CanonicalCloud cloud = canonical_cloud(PointsView(all.points));
  OnTable out{cloud.set, std::vector<Vec3>(cloud.size()), std::vector<std::uint8_t>(cloud.size()), 0};
  out.top = cloud.frame.to_unit({0, 0, 0.3})[2];
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    out.normals[cloud.point_of[i]] = all.normals[i];
    out.is_table[cloud.point_of[i]] = i >= of_ball ? 1 : 0;
  }
  return out;
}

// With the table facing down both are one closed surface but for the rim, and the top of the ball is at rest.
TEST(Restless, IsATableUnderAnObject) {
  const OnTable scene = on_table(1.2, -1);
  const SiteParts parts(scene.set, 0, sum_plan(1e-2, scene.set.size()), nullptr);
  ASSERT_EQ(parts.count(), 1U);
  const std::vector<double> unrest = parts.test(scene.normals).unrest;
  const std::vector<std::uint32_t> restless = restless_pieces(parts, 0, unrest, 0);
  EXPECT_GT(mean_over(restless, unrest), kUnrest);
  std::size_t of_table = 0;
  std::size_t of_top = 0;
  for (const std::uint32_t s : restless) {  // every point is a site
    of_table += scene.is_table[s];
    of_top += scene.set.points()[s][2] > scene.top ? 1 : 0;
  }
  std::size_t table = 0;
  for (const std::uint8_t is : scene.is_table) table += is;
  EXPECT_GT(static_cast<double>(of_table), 0.8 * static_cast<double>(table));
  EXPECT_EQ(of_top, 0U);
}

TEST(Restless, NoPieceOfAClosedSurfaceIs) {
  const OnTable ball = on_table(0, 1);
  const SiteParts parts(ball.set, 0, sum_plan(1e-2, ball.set.size()), nullptr);
  EXPECT_TRUE(restless_pieces(parts, 0, parts.test(ball.normals).unrest, 0).empty());
}

}  // namespace
}  // namespace g3r
