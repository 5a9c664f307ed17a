#include "solve/refine.h"

#include "base/median.h"
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
  FastSum sum(cloud.points(), Widths(0.1), sum_plan(1e-3, cloud.size()));
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

// The field of a sphere jumps by 1, however wide the kernels are that blur it.
TEST(RefineNormals, StrengthIsTheSameForKernelsOfAnyWidth) {
  constexpr double kNarrow = 0.12, kWide = 0.24;  // 1.5 and 3 spacings: single points are not seen, the sphere is flat
  const CanonicalCloud cloud = canonical_cloud(shapes::sphere(800).points);
  std::vector<double> widths(cloud.size());
  std::vector<Vec3> eta(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    eta[i] = cloud.points()[i];
    widths[i] = cloud.points()[i][2] > 0 ? kWide : kNarrow;
  }
  FastSum sum(cloud.points(), Widths(widths), sum_plan(1e-3, cloud.size()));
  const std::vector<double> jumps = refine_normals(sum, eta).strength;
  std::vector<double> wide, narrow;
  for (std::size_t i = 0; i < cloud.size(); ++i) (widths[i] == kWide ? wide : narrow).push_back(jumps[i]);
  EXPECT_NEAR(median(wide) / median(narrow), 1, 0.1);
  EXPECT_NEAR(sum.width(0), widths[0], 1e-6);
}

}  // namespace
}  // namespace g3r
