// Clusters: a partition, and the clustered system is the full one on vectors that are constant on each cluster.
#include "cloud/clusters.h"

#include "cloud/canonical_cloud.h"
#include "cloud/morton.h"
#include "shapes.h"
#include "solve/energy_system.h"
#include "sum/fast_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace g3r {
namespace {

TEST(Clusters, PartitionThePoints) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(3000, 0.6, 0.25, 1).points);
  const double side = 0.15;
  const Clusters clusters = cluster_points(cloud.points(), side);
  double total = 0;
  for (const double m : clusters.multiplicity) total += m;
  EXPECT_EQ(total, 3000);
  EXPECT_LT(clusters.points.size(), 1500U);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_LE(std::abs(cloud.points()[i][a] - clusters.points[clusters.cluster_of[i]][a]), side);
  }
  const std::vector<std::uint64_t> codes = morton_codes(clusters.points);
  for (std::size_t c = 1; c < codes.size(); ++c) EXPECT_LT(codes[c - 1], codes[c]);
}

// Cells are of a quarter for any side from there to a half, and each point is the mean of its own.
TEST(Clusters, AreCentroidsOfCellsOfNoMoreThanTheSide) {
  const std::vector<Vec3> points{{0.01, 0.01, 0.01}, {0.03, 0.01, 0.01}, {0.24, 0.01, 0.01}, {0.26, 0.01, 0.01}, {0.49, 0.01, 0.01}};
  for (const double side : {0.25, 0.3, 0.4999}) {
    const Clusters clusters = cluster_points(points, side);
    EXPECT_EQ(clusters.cluster_of, (std::vector<std::uint32_t>{0, 0, 0, 1, 1})) << side;
    ASSERT_EQ(clusters.points.size(), 2U);
    EXPECT_NEAR(clusters.points[0][0], 0.28 / 3, 1e-15);
    EXPECT_NEAR(clusters.points[1][0], 0.375, 1e-15);
  }
}

// Points that stand for more area count for as much in their cell.
TEST(Clusters, CountTheAreasOfTheirPoints) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(3000, 0.6, 0.25, 1).points);
  std::vector<double> relative(cloud.size());
  double all = 0;
  for (std::size_t i = 0; i < relative.size(); ++i) {
    relative[i] = 1 + static_cast<double>(i % 4);
    all += relative[i] * relative[i];
  }
  const Clusters clusters = cluster_points(cloud.points(), 0.15, relative);
  std::vector<double> areas(clusters.points.size(), 0);
  std::vector<double> counts(areas);
  for (std::size_t i = 0; i < relative.size(); ++i) {
    areas[clusters.cluster_of[i]] += relative[i] * relative[i];
    ++counts[clusters.cluster_of[i]];
  }
  EXPECT_EQ(std::accumulate(areas.begin(), areas.end(), 0.0), all);
  EXPECT_EQ(clusters.multiplicity, areas);
  for (std::size_t c = 0; c < areas.size(); ++c) {
    EXPECT_NEAR(clusters.relative_spacing[c] * clusters.relative_spacing[c] * counts[c], areas[c], 1e-12 * areas[c]);
  }
}

// Coincident pairs: the restriction is exact.
TEST(Clusters, SystemIsTheFullOneOnConstantVectors) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(600, 0.6, 0.25, 1).points);
  const std::vector<double> roots(cloud.size(), std::sqrt(2.0));
  std::vector<Vec3> doubled;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    doubled.insert(doubled.end(), 2, cloud.points()[i]);
  }
  const double width = 0.1;
  const double damping = 0.7;
  const double weight = 0.3;
  FastSum one_sum(cloud.points(), Widths(width), sum_plan(0, cloud.size()));
  FastSum all_sum(doubled, Widths(width), sum_plan(0, doubled.size()));
  EnergySystem clustered(one_sum, damping, weight, roots);
  EnergySystem full(all_sum, damping, weight);
  shapes::Random random(2);
  std::vector<Vec3> eta(cloud.size());  // of a cluster: both its points together
  std::vector<Vec3> halves;
  for (Vec3& v : eta) {
    v = random.direction();
    halves.insert(halves.end(), 2, Vec3{v[0] / 2, v[1] / 2, v[2] / 2});
  }
  const std::vector<Vec3> a = product_of(clustered, clustered.from_areas(eta));
  const std::vector<Vec3> b = product_of(full, halves);
  const std::vector<Vec3> ra = clustered.right_side();
  const std::vector<Vec3> rb = full.right_side();
  double error = 0;
  double size = 0;
  for (std::size_t i = 0; i < eta.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {  // D^T of the full product: both rows, over sqrt(2)
      error += std::pow(a[i][k] - (b[2 * i][k] + b[2 * i + 1][k]) / std::sqrt(2.0), 2);
      error += std::pow(ra[i][k] - (rb[2 * i][k] + rb[2 * i + 1][k]) / std::sqrt(2.0), 2);
      size += a[i][k] * a[i][k] + ra[i][k] * ra[i][k];
    }
  }
  constexpr double kRounding = 1e-12;  // direct sums in double
  EXPECT_LE(std::sqrt(error / size), kRounding);
}

}  // namespace
}  // namespace g3r
