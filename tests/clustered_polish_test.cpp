// Clusters of points that are polished together: alone they are what they were, and the points of a cell share their area vector.
#include "orient/clustered_polish.h"

#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace g3r {
namespace {

struct Torus {
  CanonicalCloud cloud = canonical_cloud(shapes::torus(2000).points);
  Settings settings = choose_settings({}, cloud, cloud.set.spacing(), 0.5 * cloud.set.spacing(), 0);
  Refinement start;
  std::vector<double> relative;

  Torus() {
    for (const Vec3& p : cloud.points()) start.normals.push_back(vector::normalised(p));  // rough, but on one side
    start.strength.assign(cloud.size(), 1);
  }

  [[nodiscard]] Polished polished(double side) const {
    const Monitor monitor;
    Stages stages(monitor);
    const Clusters clusters = cluster_points(cloud.points(), side, relative);
    return polish_clusters({cloud.points(), relative, clusters}, settings, mean_of_clusters(clusters, start), stages);
  }
};

TEST(ClusteredPolish, IsThePolishWhereEveryPointIsAlone) {
  const Torus torus;
  const Monitor monitor;
  Stages stages(monitor);
  const Polished alone = torus.polished(1e-4);
  const double area = torus.settings.spacing * torus.settings.spacing;
  const Polished points =
      polish({torus.cloud.points(), {}, std::vector<double>(torus.cloud.size(), area), {}}, torus.settings, torus.start, stages);
  for (std::size_t i = 0; i < torus.cloud.size(); ++i) {
    EXPECT_NEAR(vector::dot(alone.refinement.normals[i], points.refinement.normals[i]), 1, 1e-6);
    EXPECT_NEAR(alone.refinement.strength[i], points.refinement.strength[i], 1e-4 * points.refinement.strength[i]);
  }
}

TEST(ClusteredPolish, GivesThePointsOfACellOneDirectionAndTheirShareOfTheArea) {
  Torus torus;
  for (std::size_t i = 0; i < torus.cloud.size(); ++i) torus.relative.push_back(i % 2 == 0 ? 1 : 2);
  const double side = 2 * torus.settings.spacing;
  const Clusters clusters = cluster_points(torus.cloud.points(), side, torus.relative);
  ASSERT_LT(clusters.points.size(), torus.cloud.size() / 2);
  const std::vector<Vec3> eta = torus.polished(side).eta;
  for (std::size_t i = 1; i < eta.size(); ++i) {
    if (clusters.cluster_of[i] != clusters.cluster_of[i - 1]) continue;
    const double share = std::pow(torus.relative[i] / torus.relative[i - 1], 2);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(eta[i][a], share * eta[i - 1][a], 1e-12);
  }
}

TEST(ClusteredPolish, StartsShortWhereAClusterFacesEitherWay) {
  Clusters clusters;
  clusters.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  clusters.cluster_of = {0, 0, 1, 1, 2};
  const Refinement mean = mean_of_clusters(clusters, {{{0, 0, 1}, {0, 0, -1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}}, {1, 1, 0.5, 1, 0.25}});
  EXPECT_EQ(mean.strength, (std::vector<double>{0, 0.75, 0.25}));
  EXPECT_EQ(mean.normals[1], (Vec3{0, 0, 1}));
  EXPECT_EQ(mean.normals[2], (Vec3{1, 0, 0}));
}

}  // namespace
}  // namespace g3r
