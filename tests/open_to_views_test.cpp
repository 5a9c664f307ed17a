// What sensors have seen from known places faces them, and nothing of it is closed.
#include "orient/open_to_views.h"

#include "base/vector.h"
#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

// A ball, of whose points every third has the wrong side, seen from two places.
struct SeenBall {
  SeenBall() : ball(shapes::sphere(600)) {
    views.places = {{4, 0, 0}, {-4, 0, 0}};
    for (std::size_t i = 0; i < ball.points.size(); ++i) {
      views.of_point.push_back(ball.points[i][0] > 0 ? 0 : 1);
      const double side = i % 3 == 0 ? -1 : 1;
      solution.refinement.normals.push_back(vector::scale(ball.normals[i], side));
      solution.eta.push_back(vector::scale(ball.normals[i], side * ball.areas[i]));
    }
  }
  [[nodiscard]] double cosine(std::size_t i) const {
    const Vec3 to_sensor = vector::normalised(vector::subtract(views.place_of(i), ball.points[i]));
    return vector::dot(solution.refinement.normals[i], to_sensor);
  }
  shapes::Surface ball;
  Views views;
  Solution solution;
};

TEST(OpenToViews, TurnsEveryPointToItsSensorAndItsAreaWithIt) {
  SeenBall seen;
  const SeenBall before;
  open_to_views(seen.views, seen.ball.points, seen.solution);
  const OpenSurfaces& surfaces = seen.solution.open_surfaces;
  for (std::size_t i = 0; i < seen.ball.points.size(); ++i) {
    EXPECT_GE(seen.cosine(i), 0) << i;
    EXPECT_GT(vector::dot(seen.solution.eta[i], seen.solution.refinement.normals[i]), 0) << i;
    EXPECT_EQ(seen.solution.turned_to_views[i] != 0, before.cosine(i) < 0) << i;
    EXPECT_TRUE(surfaces.is_open(i)) << i;
    EXPECT_FALSE(surfaces.is_choice(i)) << i;
    EXPECT_EQ(surfaces.part[i], 0U) << i;  // one part, named by its first point
  }
}

// Where the surface is seen edge-on the side is a choice, a half; where it is seen squarely it is certain.
TEST(OpenToViews, CertifiesWhatIsSeenSquarely) {
  SeenBall seen;
  open_to_views(seen.views, seen.ball.points, seen.solution);
  for (std::size_t i = 0; i < seen.ball.points.size(); ++i) {
    EXPECT_FLOAT_EQ(seen.solution.open_surfaces.certified[i], static_cast<float>((1 + std::abs(seen.cosine(i))) / 2)) << i;
  }
}

TEST(OpenToViews, LeavesOpenSurfacesAsTheyAre) {
  SeenBall seen;
  OpenSurfaces& surfaces = seen.solution.open_surfaces;
  surfaces.resize(seen.ball.points.size());
  surfaces.certified.assign(seen.ball.points.size(), 0.25F);
  for (std::size_t i = 100; i < 200; ++i) surfaces.part[i] = 100;
  const SeenBall before;
  open_to_views(seen.views, seen.ball.points, seen.solution);
  for (std::size_t i = 100; i < 200; ++i) {
    EXPECT_EQ(surfaces.part[i], 100U);
    EXPECT_EQ(surfaces.certified[i], 0.25F);
    EXPECT_EQ(seen.solution.refinement.normals[i], before.solution.refinement.normals[i]);
    EXPECT_EQ(seen.solution.turned_to_views[i], 0);
  }
}

}  // namespace
}  // namespace g3r
