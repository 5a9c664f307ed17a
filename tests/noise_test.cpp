// The size of the noise: exact on what it is defined by, near the truth on walls and on noise larger than the spacing.
#include "cloud/noise.h"
#include "cloud/neighbours.h"
#include "cloud/spacing.h"
#include "sanitized.h"
#include "shapes.h"

#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

// Moments and cumulants of the even distribution on [-1/2, 1/2].
TEST(Noise, RoundingHasTheMomentsOfAnEvenDistribution) {
  EXPECT_DOUBLE_EQ(kRoundingVariance, 1.0 / 12);
  EXPECT_DOUBLE_EQ(rounding_moment(4), 1.0 / 80);
  EXPECT_NEAR(kRoundingCumulant, -1.0 / 120, 1e-15);
}

double estimate(const Surface& s) { return estimate_noise(PointSet(s.points)); }

TEST(Noise, IsNearTheTruthFromAQuarterOfTheSpacingToThreeSpacings) {
  const Surface clean = shapes::torus(40000, 0.6, 0.25, 6);
  const double h = std::sqrt(std::accumulate(clean.areas.begin(), clean.areas.end(), 0.0) / 40000);
  for (const double sigma : kSanitized ? std::vector<double>{0.5, 2.0} : std::vector<double>{0.25, 0.5, 1.0, 2.0, 3.0}) {
    Surface noisy = clean;
    shapes::scatter(noisy, sigma * h);
    EXPECT_NEAR(estimate(noisy) / (sigma * h), 1, 0.17) << sigma;
  }
}

// Both sides of a plate are among the 32 neighbours of a point, and it was 2.1 times the truth.
TEST(Noise, WallsOfFourDeviationsDoNotRaiseIt) {
  Surface plates = shapes::plates(3, 1.2, 3, 6, 0.02);
  const double sigma = 0.75 * 0.02;
  shapes::scatter(plates, sigma);
  EXPECT_NEAR(estimate(plates) / sigma, 1, 0.25);
}

// With a weight of the winding number in proportion to h the steps fit noise: an error of 0.0055, and many sides unsure.
TEST(Noise, OfManyPointsIsNotFitted) {
  Surface s = shapes::torus(160000, 0.6, 0.25, 6);
  shapes::scatter(s, 0.006);
  const Orientation o = orient(s.points);
  EXPECT_GE(shapes::share_correct(o.normals, s.normals), 0.9999);
  EXPECT_LE(shapes::angle_error(o.normals, s.normals), 0.004);
  EXPECT_TRUE(o.stats.consistent);
  EXPECT_TRUE(o.stats.warnings.empty());
}

TEST(Noise, PointsInAVolumeHaveNoSurface) {
  shapes::Random random(5);
  std::vector<Vec3> volume;
  for (int i = 0; i < 5000; ++i) volume.push_back({random.gaussian(), random.gaussian(), random.gaussian()});
  EXPECT_GT(dimension(PointSet(volume)), 2.9);
  Surface torus = shapes::torus(20000, 0.6, 0.25, 6);
  shapes::scatter(torus, 0.03);
  EXPECT_LT(dimension(PointSet(torus.points)), 2.5);
  const Orientation o = orient(volume);
  EXPECT_FALSE(o.stats.consistent);
  EXPECT_TRUE(std::any_of(o.stats.warnings.begin(), o.stats.warnings.end(),
                          [](const std::string& w) { return w.find("volume") != std::string::npos; }));
}

// Every point is looked at, and 16 neighbours of each.
TEST(Dimension, IsThatOfTheNeighboursOfItsDefinition) {
  const std::vector<Vec3> points = shapes::sphere(260).points;
  std::vector<double> found;
  for (const Vec3& p : points) {
    std::vector<double> distance;
    for (const Vec3& q : points) distance.push_back(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    std::sort(distance.begin(), distance.end());  // the first is the point itself
    found.push_back(std::log(4) / std::log(distance[16] / distance[4]));
  }
  std::sort(found.begin(), found.end());
  EXPECT_NEAR(dimension(PointSet(points)), found[found.size() / 2], 1e-9);
}

TEST(Noise, IsEstimatedAndNotMistakenForShape) {
  shapes::Random random(4);
  const Surface clean = shapes::torus(8000, 0.6, 0.25, 6);
  const Surface two_layers = shapes::join(shapes::sphere(6000, 0.5), shapes::sphere(6000, 0.49), true);
  EXPECT_EQ(plan(clean.points).noise, 0);
  EXPECT_EQ(plan(two_layers.points).noise, 0);
  for (const double sigma : {0.01, 0.02}) {
    Surface noisy = clean;
    for (Vec3& p : noisy.points) {
      for (double& c : p) c += sigma * random.gaussian();
    }
    EXPECT_NEAR(plan(noisy.points).noise / sigma, 1, 0.4);
    EXPECT_GE(shapes::share_correct(orient(noisy.points).normals, noisy.normals), 0.999);
  }
}

// The narrow kernels of clean clouds would follow it: an error of 0.02.
TEST(Noise, OfATwentiethOfTheSpacingIsFound) {
  shapes::Random random(4);
  Surface s = shapes::torus(12000, 0.6, 0.25, 6);
  const double spacing = plan(s.points).spacing;
  for (Vec3& p : s.points) {
    for (double& c : p) c += 0.05 * spacing * random.gaussian();
  }
  EXPECT_NEAR(plan(s.points).noise / spacing, 0.05, 0.03);
  EXPECT_LE(shapes::angle_error(orient(s.points).normals, s.normals), 0.005);
}

// Plates 2.5 spacings thick and 2.5 apart, noise of 0.35 spacings: neighbourhoods of 32 points see both sides of a plate.
TEST(Noise, PlatesDoNotRaiseIt) {
  Surface plates = shapes::plates(4, 0.7, 2.5, 2.5, 0.02);
  const double sigma = 0.35 * 0.02;
  shapes::scatter(plates, sigma);
  EXPECT_NEAR(plan(plates.points).noise / sigma, 1, 0.4);
  EXPECT_GE(shapes::share_correct(orient(plates.points).normals, plates.normals), 0.85);
}

// 95,000 points on walls 3 spacings thick: a start from the field of fewer points has 55 % of the sides.
TEST(Noise, ManyPointsOnThinWallsKeepTheirSides) {
  if (kSanitized) GTEST_SKIP() << "the code of smaller clouds, for minutes";
  Surface plates = shapes::plates(6, 1.1, 3, 4, 0.02);
  shapes::scatter(plates, 0.5 * 0.02);
  EXPECT_GE(shapes::share_correct(orient(plates.points).normals, plates.normals), 0.88);
}

// Solved as noisy clouds are, 2 % of the sides were wrong.
TEST(Noise, SlightNoiseOnPlatesCostsNoSides) {
  Surface plates = shapes::plates(8, 0.7, 2.5, 3.5, 0.02);
  shapes::scatter(plates, 0.1 * 0.02);
  EXPECT_GE(shapes::share_correct(orient(plates.points).normals, plates.normals), 0.998);
}

// Plates 0.7 spacings thick and as far apart: no neighbourhood has a single side in it.
TEST(Noise, PlatesWithoutSingleSidesAreClean) {
  const Surface plates = shapes::plates(6, 0.6, 0.7, 0.7, 0.02);
  EXPECT_EQ(estimate(plates), 0);
  EXPECT_GE(shapes::share_correct(orient(plates.points).normals, plates.normals), 0.9);
}

TEST(Noise, CurvedWallsCloseTogetherAreClean) {
  Surface walls;
  std::uint64_t seed = 1;
  for (const double radius : {0.3, 0.28, 0.25, 0.23}) {  // 0.5 and 0.76 spacings apart
    walls = shapes::join(walls, shapes::torus(static_cast<std::size_t>(16000 * radius / 1.06), 0.6, radius, seed++));
  }
  EXPECT_EQ(estimate(walls), 0);
}

// Where a shape is small for its points, curvature lifts most residuals, but not all; noise lifts all.
TEST(Noise, FewPointsOnUnevenShapesAreClean) {
  const Surface ellipsoid = shapes::ellipsoid(400, 1, 0.3, 0.1);
  EXPECT_EQ(estimate(ellipsoid), 0);
  EXPECT_EQ(estimate(shapes::ellipsoid(280, 1, 0.3, 0.1)), 0);  // no residual is small, but some are far smaller than others
  EXPECT_EQ(estimate(shapes::torus(600, 0.6, 0.1, 3)), 0);
  Surface noisy = ellipsoid;
  shapes::scatter(noisy, 0.02);
  EXPECT_GT(estimate(noisy), 0.01);
}

// Rounding puts many noisy points on planes.
TEST(Noise, RoundedCoordinatesDoNotHideIt) {
  Surface s = shapes::torus(12000, 0.6, 0.25, 6);
  const double h = plan(s.points).spacing;
  shapes::scatter(s, 0.4 * h);
  for (Vec3& p : s.points) {
    for (double& c : p) c = std::round(c / (0.4 * h)) * 0.4 * h;
  }
  EXPECT_NEAR(estimate(s) / h, 0.41, 0.1);
}

// Rows of heights, turned so that no coordinate is rounded, lie in planes with any noise; in a raster columns and diagonals do as well.
Surface rows(bool raster, double sigma) {
  shapes::Random random(8);
  Surface s;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) {
      const double x = i, y = raster ? j : random.uniform(0, 100);
      const double z = 8 * std::sin(x / 15) * std::cos(y / 12) + sigma * random.gaussian();
      s.points.push_back({0.6 * x + 0.8 * z, 0.64 * x + 0.6 * y - 0.48 * z, 0.48 * x - 0.8 * y - 0.36 * z});
    }
  }
  return s;
}

TEST(Noise, OfRastersAndScanLinesIsFound) {
  for (const double sigma : {0.4, 0.8, 1.5, 2.5}) {
    EXPECT_GT(estimate(rows(true, sigma)), 0.45 * sigma) << sigma;
    EXPECT_GT(estimate(rows(false, sigma)), 0.45 * sigma) << sigma;
  }
}

double fine_noise_of(const Surface& s) { return fine_noise(PointSet(s.points)) / PointSet(s.points).spacing(); }

// Below the least that kernels have to hide: known on smooth surfaces and on planes, not where shape is as large.
TEST(FineNoise, IsThatOfSmoothSurfacesAndNotShape) {
  for (const double sigma : {0.005, 0.01, 0.02, 0.03}) {
    Surface smooth = shapes::sphere(10000);
    shapes::scatter(smooth, sigma * std::sqrt(4 * std::numbers::pi / 10000));
    EXPECT_NEAR(fine_noise_of(smooth) / sigma, 1.1, 0.15) << sigma;  // the spacing is a little less
  }
  Surface noisy = shapes::sphere(10000);
  shapes::scatter(noisy, 0.1 * std::sqrt(4 * std::numbers::pi / 10000));
  EXPECT_EQ(fine_noise_of(noisy), 0);  // that is no fine noise
  EXPECT_EQ(fine_noise_of(shapes::sphere(10000)), 0);
  EXPECT_EQ(fine_noise_of(shapes::torus(1500, 0.6, 0.1, 6)), 0);
  EXPECT_EQ(fine_noise_of(shapes::plates(6, 0.6, 0.7, 0.7, 0.02)), 0);
}

double scatter_of(const Surface& s) { return largest_scatter(PointSet(s.points)); }

TEST(Scatter, IsTheNoiseWhereThatIsEven) {
  const Surface clean = shapes::torus(40000, 0.6, 0.25, 6);
  const double h = std::sqrt(std::accumulate(clean.areas.begin(), clean.areas.end(), 0.0) / 40000);
  for (const double sigma : {0.1, 0.25, 0.5, 1.0}) {
    Surface noisy = clean;
    shapes::scatter(noisy, sigma * h);
    EXPECT_NEAR(scatter_of(noisy) / (sigma * h), 1, 0.2) << sigma;
  }
}

TEST(Scatter, IsNoneOnExactPlanes) { EXPECT_EQ(scatter_of(shapes::plates(6, 0.6, 0.7, 0.7, 0.02)), 0); }

// The least noise is what the estimate goes by; with it 84 % of the sides were right.
TEST(Noise, ThatDiffersFromPlaceToPlaceIsSeen) {
  if (kSanitized) GTEST_SKIP() << "the code of the next test, for minutes";
  shapes::Random random(2);
  Surface s = shapes::torus(20000, 0.6, 0.25, 6);
  const double h = plan(s.points).spacing;
  for (Vec3& p : s.points) {
    const double sigma = (p[0] > 0 ? 0.8 : 0.04) * h;
    for (double& c : p) c += sigma * random.gaussian();
  }
  const Orientation o = orient(s.points);
  EXPECT_GE(shapes::share_correct(o.normals, s.normals), 0.999);
  EXPECT_NEAR(o.stats.noise / h, 0.7, 0.4);
  EXPECT_TRUE(o.stats.consistent);
}

// Scans of an ellipsoid from all around, each a little off: layers that are smooth and close together, as thin walls are. Taken for walls,
// a ninth of the sides was wrong.
TEST(Noise, ScansThatDoNotFitAreNoWalls) {
  shapes::Random random(3);
  const Surface all = shapes::ellipsoid(36000, 1, 0.7, 0.6);
  const double h = 0.02;
  Surface scans;
  for (int scan = 0; scan < 12; ++scan) {
    const Vec3 view = random.direction();
    const Vec3 off = random.direction();
    const double distance = random.uniform(0, 1.5) * h;
    for (std::size_t i = static_cast<std::size_t>(scan); i < all.points.size(); i += 12) {
      Vec3 p = all.points[i];
      const Vec3& n = all.normals[i];
      if (n[0] * view[0] + n[1] * view[1] + n[2] * view[2] < 0.3) continue;
      for (std::size_t a = 0; a < 3; ++a) p[a] += distance * off[a];
      scans.points.push_back(p);
      scans.normals.push_back(n);
    }
  }
  const Orientation o = orient(scans.points);
  EXPECT_GE(shapes::share_correct(o.normals, scans.normals), 0.999);
  EXPECT_GT(o.stats.noise / o.stats.spacing, 0.1);
}

// The ellipsoid of axes 1, 0.7, 0.6 in voxels of these sides.
Surface voxels_of(const Vec3& steps) {
  const Surface s = shapes::ellipsoid(60000, 1, 0.7, 0.6);
  std::map<std::array<std::int64_t, 3>, Vec3> normal_of;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    std::array<std::int64_t, 3> voxel{};
    for (std::size_t a = 0; a < 3; ++a) voxel[a] = std::llround(s.points[i][a] / steps[a]);
    normal_of.emplace(voxel, s.normals[i]);
  }
  Surface voxels;
  for (const auto& [voxel, normal] : normal_of) {
    Vec3 p{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = steps[a] * static_cast<double>(voxel[a]);
    voxels.points.push_back(p);
    voxels.normals.push_back(normal);
  }
  return voxels;
}

// Terraces of voxels are exact planes, and their steps were taken for shape.
TEST(Noise, VoxelsCountAsNoise) {
  const double step = 0.02;
  const Surface voxels = voxels_of({step, step, step});
  const Orientation o = orient(voxels.points);
  EXPECT_NEAR(plan(voxels.points).noise / step, 1 / std::sqrt(12.0), 1e-6);
  EXPECT_GE(shapes::share_correct(o.normals, voxels.normals), 0.999);
  EXPECT_LE(shapes::angle_error(o.normals, voxels.normals), 0.02);
}

// Slices of a scanner that are thicker than its pixels: whole neighbourhoods are in one slice, exactly, and none is on the surface.
TEST(Noise, VoxelsOfThickSlicesCountAsNoise) {
  for (const double thickness : {2.0, 3.0, 5.0}) {
    const Vec3 steps{0.02, 0.02, 0.02 * thickness};
    const Surface voxels = voxels_of(steps);
    const Orientation o = orient(voxels.points);
    EXPECT_NEAR(plan(voxels.points).noise, std::hypot(steps[0], steps[1], steps[2]) / 6, 1e-6) << thickness;
    EXPECT_GE(shapes::share_correct(o.normals, voxels.normals), 0.999) << thickness;
  }
}

// Boundary voxels of a segmented solid fill terraces, and most of thick slices are inside of them and look exact; the sides do not agree
// then, but do if the voxels count as rounded.
TEST(Noise, TerracesAreTriedAsRounded) {
  const Vec3 steps{0.04, 0.04, 0.48}, axes{2, 2, 1.3};
  const auto inside = [&](int x, int y, int z) {
    return std::hypot(x * steps[0] / axes[0], y * steps[1] / axes[1], z * steps[2] / axes[2]) < 1;
  };
  Surface voxels;
  for (int x = -51; x <= 51; ++x) {
    for (int y = -51; y <= 51; ++y) {
      for (int z = -3; z <= 3; ++z) {
        const bool filled = inside(x + 1, y, z) && inside(x - 1, y, z) && inside(x, y + 1, z) && inside(x, y - 1, z) &&
                            inside(x, y, z + 1) && inside(x, y, z - 1);
        if (filled || !inside(x, y, z)) continue;
        voxels.points.push_back({x * steps[0], y * steps[1], z * steps[2]});
        voxels.normals.push_back({x * steps[0], y * steps[1], z * steps[2]});  // to the same side as the ellipsoid's
      }
    }
  }
  EXPECT_EQ(estimate(voxels), 0);
  const Orientation o = orient(voxels.points);
  std::size_t outward = 0;
  for (std::size_t i = 0; i < voxels.points.size(); ++i) {
    const Vec3 &n = o.normals[i], &r = voxels.normals[i];
    outward += n[0] * r[0] + n[1] * r[1] + n[2] * r[2] > 0 ? 1 : 0;
  }
  EXPECT_EQ(outward, voxels.points.size());
}

// A grid on a cube is a lattice too.
TEST(Noise, IntegerCoordinatesAreNoNoiseByThemselves) {
  Surface cube;
  const int side = 40;
  for (int x = 0; x <= side; ++x) {
    for (int y = 0; y <= side; ++y) {
      for (int z = 0; z <= side; ++z) {
        const bool inside = x > 0 && x < side && y > 0 && y < side && z > 0 && z < side;
        if (!inside) cube.points.push_back({1.0 * x, 1.0 * y, 1.0 * z});
      }
    }
  }
  EXPECT_EQ(estimate(cube), 0);
}

// Rays on a grid hit a plate from above and below: its two heights are two steps, and no rounding. With directions of noisy points the
// mesh had 45 handles along the planes of the octree.
TEST(Noise, PlatesHitByRaysOnAGridAreClean) {
  for (const double thickness : {0.5, 1.0, 2.0}) {
    Surface plate;
    for (int x = 0; x < 300; x += 2) {
      for (int y = 0; y < 200; y += 2) {
        for (const double z : {0.0, thickness}) plate.points.push_back({1.0 * x, 1.0 * y, z});
      }
    }
    EXPECT_EQ(estimate(plate), 0) << thickness;
  }
}

// Menger's sponge of second order: 9^3 cells, random points on the faces between full and empty ones.
Surface sponge(int count) {
  const auto full = [](int x, int y, int z) {
    if (std::min({x, y, z}) < 0 || std::max({x, y, z}) > 8) return false;
    const auto hole = [](int a, int b, int c) { return (a == 1) + (b == 1) + (c == 1) >= 2; };
    return !hole(x / 3, y / 3, z / 3) && !hole(x % 3, y % 3, z % 3);
  };
  shapes::Random random(1);
  Surface s;
  while (static_cast<int>(s.points.size()) < count) {
    const std::array<int, 3> cell{static_cast<int>(random.uniform(0, 9)), static_cast<int>(random.uniform(0, 9)),
                                  static_cast<int>(random.uniform(0, 9))};
    const auto axis = static_cast<std::size_t>(random.uniform(0, 3));
    const int side = random.uniform() < 0.5 ? -1 : 1;
    std::array<int, 3> other = cell;
    other[axis] += side;
    if (!full(cell[0], cell[1], cell[2]) || full(other[0], other[1], other[2])) continue;
    Vec3 p{};
    Vec3 n{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = cell[a] + random.uniform();
    p[axis] = cell[axis] + (side > 0 ? 1 : 0);
    n[axis] = side;
    s.points.push_back(p);
    s.normals.push_back(n);
  }
  return s;
}

// So few points on so much shape look like noise, and solved as such half of the sides was wrong.
TEST(Noise, OfFewPointsMayBeShape) {
  const Surface s = sponge(550);
  EXPECT_GT(estimate(s), 0);
  const Orientation o = orient(s.points);
  EXPECT_EQ(o.stats.noise, 0);
  EXPECT_GE(shapes::share_correct(o.normals, s.normals), 0.85);
}

}  // namespace
}  // namespace g3r
