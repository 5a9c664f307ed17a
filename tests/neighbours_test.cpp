#include "cloud/neighbours.h"

#include "cpu/parallel.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace g3r {
namespace {

constexpr std::size_t kCount = 300;
constexpr std::size_t kBuiltInParts = 20000;
constexpr std::size_t kNear = 3;

std::vector<Vec3> cube() {
  shapes::Random random(9);
  std::vector<Vec3> points(kCount);
  for (Vec3& p : points) p = {random.uniform(), random.uniform(), random.uniform()};
  return points;
}

double squared_distance(const Vec3& a, const Vec3& b) {
  return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

// All points, nearest to x first.
std::vector<std::uint32_t> sorted_around(const Vec3& x, const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> index(points.size());
  std::iota(index.begin(), index.end(), 0U);
  std::sort(index.begin(), index.end(),
            [&](std::uint32_t i, std::uint32_t j) { return squared_distance(x, points[i]) < squared_distance(x, points[j]); });
  return index;
}

TEST(Neighbours, AreThoseOfALookAtAllPoints) {
  const std::vector<Vec3> points = cube();
  const Neighbours neighbours(points);
  const Vec3 x{0.3, 1.2, 0.5};
  std::vector<std::uint32_t> index = sorted_around(x, points), found;
  std::vector<double> squared;
  neighbours.nearest(x, 20, found, squared);
  EXPECT_EQ(found, std::vector<std::uint32_t>(index.begin(), index.begin() + 20));
  for (std::size_t k = 0; k < 20; ++k) EXPECT_DOUBLE_EQ(squared[k], squared_distance(x, points[found[k]]));
  neighbours.nearest(x, 2 * kCount, found, squared);
  EXPECT_EQ(found, index);
}

TEST(Neighbours, OfAllBeginWithThePointItself) {
  const std::vector<Vec3> points = cube();
  const std::vector<std::uint32_t> all = Neighbours(points).of_all(5);
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::vector<std::uint32_t> index = sorted_around(points[i], points);
    EXPECT_EQ(all[5 * i], i);
    EXPECT_TRUE(std::equal(index.begin(), index.begin() + 5, all.begin() + static_cast<std::ptrdiff_t>(5 * i)));
  }
}

TEST(Neighbours, WithinARadiusAreAllThatAreCloser) {
  const std::vector<Vec3> points = cube();
  const Vec3 x{0.5, 0.5, 0.5};
  std::vector<std::uint32_t> found;
  Neighbours(points).within(x, 0.3, found);
  std::sort(found.begin(), found.end());
  std::vector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    if (squared_distance(x, points[i]) < 0.3 * 0.3) expected.push_back(i);
  }
  EXPECT_EQ(found, expected);
}

TEST(Neighbours, WithinARadiusStopBeyondTheMostThatAreWanted) {
  constexpr std::size_t kMost = 20;
  const std::vector<Vec3> points = cube();
  const Vec3 x{0.5, 0.5, 0.5};
  std::vector<std::uint32_t> found;
  Neighbours(points).within(x, 1, found, kMost);
  EXPECT_GT(found.size(), kMost);
  EXPECT_LT(found.size(), 2 * kMost);  // a leaf more
  std::vector<std::uint32_t> all;
  Neighbours(points).within(x, 0.1, all);
  ASSERT_LE(all.size(), kMost);
  Neighbours(points).within(x, 0.1, found, kMost);
  EXPECT_EQ(found, all);
}

// Many are far more than a leaf holds, and than one thread builds alone.
TEST(Neighbours, OfManyAndOfTheMarkedAreThoseOfALookAtAllPoints) {
  shapes::Random random(4);
  std::vector<Vec3> points(20000);
  for (Vec3& p : points) p = {random.uniform(), random.uniform() * random.uniform(), 1e-3 * random.uniform()};
  std::vector<std::uint8_t> marks(points.size());
  for (std::size_t i = 0; i < marks.size(); ++i) marks[i] = i % 3 == 0 ? 1 : 0;
  const Neighbours neighbours(points);
  std::vector<std::uint32_t> found;
  std::vector<double> squared;
  for (int trial = 0; trial < 10; ++trial) {
    const Vec3 x{random.uniform(-0.5, 1.5), random.uniform(), random.uniform(-1e-3, 1e-3)};
    std::vector<std::uint32_t> index = sorted_around(x, points);
    for (const int k : {40, 300}) {
      neighbours.nearest(x, static_cast<std::size_t>(k), found, squared);
      EXPECT_EQ(found, std::vector<std::uint32_t>(index.begin(), index.begin() + k));
    }
    index.erase(std::remove_if(index.begin(), index.end(), [&](std::uint32_t i) { return marks[i] == 0; }), index.end());
    neighbours.nearest_marked(x, 9, marks, found, squared);
    EXPECT_EQ(found, std::vector<std::uint32_t>(index.begin(), index.begin() + 9));
  }
}

TEST(Neighbours, AsFarAsOneAnotherAreInTheOrderOfTheirIndices) {
  std::vector<Vec3> grid;
  for (int i = 0; i < 1000; ++i)
    grid.push_back({static_cast<double>(i * 7 % 10), static_cast<double>(i / 10 % 10), static_cast<double>(i / 100)});
  const Neighbours neighbours(grid);
  std::vector<std::uint32_t> found;
  std::vector<double> squared;
  for (const Vec3& x : {Vec3{4, 5, 5}, Vec3{4.5, 4.5, 4.5}, Vec3{0, 9, -1}}) {
    std::vector<std::uint32_t> index(grid.size());
    std::iota(index.begin(), index.end(), 0U);
    std::stable_sort(index.begin(), index.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return squared_distance(x, grid[i]) < squared_distance(x, grid[j]); });
    for (const int k : {22, 200}) {
      neighbours.nearest(x, static_cast<std::size_t>(k), found, squared);
      EXPECT_EQ(found, std::vector<std::uint32_t>(index.begin(), index.begin() + k));
    }
    double nearest = 100;
    EXPECT_EQ(neighbours.nearest(x, nearest, 0), index.front());
  }
}

TEST(Neighbours, AreNoneBeyondTheGivenDistance) {
  const std::vector<Vec3> points = cube();
  const Neighbours neighbours(points);
  double squared = 0.01;
  EXPECT_EQ(neighbours.nearest({5, 5, 5}, squared, 77), 77U);
  squared = 100;
  EXPECT_EQ(neighbours.nearest({5, 5, 5}, squared, 77), sorted_around({5, 5, 5}, points).front());
}

// So many points that threads build parts of the tree side by side.
TEST(Neighbours, AreTheSameForAnyNumberOfThreads) {
  shapes::Random random(3);
  std::vector<Vec3> points(kBuiltInParts);
  for (Vec3& p : points) p = {random.uniform(), random.uniform(), random.uniform()};
  const auto nearest_of_all = [&](int threads) {
    return parallel::with_threads(threads, [&] { return Neighbours(points).of_all(kNear); });
  };
  EXPECT_EQ(nearest_of_all(4), nearest_of_all(1));
}

}  // namespace
}  // namespace g3r
