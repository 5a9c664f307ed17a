#include "solve/refine.h"

#include "cloud/canonical_cloud.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace g3r {
namespace {

TEST(Normalised, AreUnitVectorsAlongTheGivenOnes) {
  const std::vector<Vec3> unit = normalised({{3, 0, -4}, {0, 0, 0}, {0, 1e-200, 0}});
  EXPECT_EQ(unit[0], (Vec3{0.6, 0, -0.8}));
  EXPECT_EQ(unit[1], (Vec3{0, 0, 1}));
}

TEST(UnitNormals, KeepTheVectorsWhereTheGradientVanishes) {
  const Refinement refined = unit_normals({{0, 0, 0}, {0, -2, 0}}, {{0, 5, 0}, {1, 0, 0}});
  EXPECT_EQ(refined.normals, (std::vector<Vec3>{{0, 1, 0}, {0, -1, 0}}));
  EXPECT_EQ(refined.strength, (std::vector<double>{0, 2}));
}

// Area vectors of a sphere whose directions are wrong by 0.3 at random: their field has the directions of the sphere.
TEST(RefineNormals, MakesDirectionsOfTheFieldWhateverTheSizeOfTheVectors) {
  const shapes::Surface sphere = shapes::sphere(800);
  const CanonicalCloud cloud = canonical_cloud(sphere.points);
  std::vector<Vec3> truth(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.points()[i];
    const double size = std::hypot(p[0], p[1], p[2]);
    truth[i] = {p[0] / size, p[1] / size, p[2] / size};
  }
  const std::vector<Vec3> disturbed = shapes::disturbed(truth, 0.3);
  FastSum sum(cloud.points(), cloud.morton(), Widths(0.1), sum_plan(1e-3, cloud.size()));
  const std::vector<Vec3> normals = refine_normals(sum, disturbed).normals;
  EXPECT_LT(shapes::angle_error(normals, truth), 0.2 * shapes::angle_error(disturbed, truth));
  std::vector<Vec3> larger = disturbed;
  for (Vec3& v : larger) {
    for (double& x : v) x *= 4;
  }
  const std::vector<Vec3> same = refine_normals(sum, larger).normals;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(same[i][a], normals[i][a], 1e-5);  // sums are in single precision
  }
}

}  // namespace
}  // namespace g3r
