// orient() gives the same for every order of the points, number of threads, place, scale and motion of the cloud.
#include <g3r/g3r.h>

#include "base/vector.h"
#include "sanitized.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

TEST(Orient, IsTheSameForEveryOrderOfThePoints) {
  const Surface s = shapes::torus(3000, 0.6, 0.25, 8);
  std::vector<Vec3> shuffled = s.points;
  std::vector<std::size_t> from(shuffled.size());
  shapes::Random random(2);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = i;
  for (std::size_t i = from.size(); i-- > 1;) std::swap(from[i], from[random.bits() % (i + 1)]);
  for (std::size_t i = 0; i < from.size(); ++i) shuffled[i] = s.points[from[i]];
  const Orientation a = orient(s.points);
  const Orientation b = orient(shuffled);
  for (std::size_t i = 0; i < from.size(); ++i) {
    ASSERT_EQ(a.normals[from[i]], b.normals[i]);
    ASSERT_EQ(a.areas[from[i]], b.areas[i]);
    ASSERT_EQ(a.confidence[from[i]], b.confidence[i]);
  }
}

TEST(Orient, IsTheSameForEveryNumberOfThreads) {
  const Surface s = shapes::torus(kSanitized ? 2500 : 6000, 0.6, 0.25, 8);
  Options options;
  options.threads = 1;
  const Orientation one = orient(s.points, options);
  for (const int threads : {2, 3, 8}) {
    options.threads = threads;
    const Orientation many = orient(s.points, options);
    EXPECT_EQ(one.normals, many.normals) << threads;
    EXPECT_EQ(one.areas, many.areas) << threads;
    EXPECT_EQ(one.confidence, many.confidence) << threads;
  }
}

double largest_angle(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec3 d{a[i][0] - b[i][0], a[i][1] - b[i][1], a[i][2] - b[i][2]};
    largest = std::max(largest, 2 * std::asin(std::min(1.0, std::hypot(d[0], d[1], d[2]) / 2)) * 180 / std::numbers::pi);
  }
  return largest;
}

TEST(Orient, DoesNotDependOnPlaceOrScale) {
  const Surface s = shapes::torus(4000, 0.6, 0.25, 6);
  std::vector<Vec3> base = s.points;
  for (Vec3& p : base) {  // quantised to what double holds at UTM size, so that both clouds are the same shape exactly
    for (double& c : p) c = std::round(c * 0x1p24) * 0x1p-24;
  }
  const Orientation origin = orient(base);
  std::vector<Vec3> utm = base;
  for (Vec3& p : utm) {
    p[0] += 500000;
    p[1] += 5000000;
    p[2] += 1000;
  }
  EXPECT_LE(largest_angle(orient(utm).normals, origin.normals), 1e-3);
  for (const double scale : {0x1p-100, 0x1p20, 1e-30, 1e30, 1e6}) {
    std::vector<Vec3> scaled = base;
    for (Vec3& p : scaled) {
      for (double& c : p) c *= scale;
    }
    const Orientation o = orient(scaled);
    // Scales that are no powers of two round: two boxes at the edge of the opening rule may be summed either way.
    EXPECT_LE(largest_angle(o.normals, origin.normals), 2e-2) << scale;
    EXPECT_NEAR(o.areas[7] / (origin.areas[7] * scale * scale), 1, 1e-3);
  }
}

// A rotation by a unit quaternion (w, x, y, z).
Vec3 rotated(const std::array<double, 4>& q, const Vec3& p) {
  const auto [w, x, y, z] = q;
  return {(1 - 2 * (y * y + z * z)) * p[0] + 2 * (x * y - w * z) * p[1] + 2 * (x * z + w * y) * p[2],
          2 * (x * y + w * z) * p[0] + (1 - 2 * (x * x + z * z)) * p[1] + 2 * (y * z - w * x) * p[2],
          2 * (x * z - w * y) * p[0] + 2 * (y * z + w * x) * p[1] + (1 - 2 * (x * x + y * y)) * p[2]};
}

// And with its mirror image: sides are the same, and directions but for the order of the points and the boxes that they are summed in.
TEST(Orient, MovesWithTheCloud) {
  const Surface s = shapes::join(shapes::torus(1400, 0.6, 0.25, 6), shapes::sphere(300, 0.2));
  const std::vector<Vec3> still = orient(s.points).normals;
  shapes::Random random(11);
  const int motions = kSanitized ? 3 : 10;
  for (int m = 0; m < motions; ++m) {
    std::array<double, 4> q{};
    double size = 0;
    do {  // uniform in the ball: its direction is a uniform rotation
      for (double& c : q) c = random.uniform(-1, 1);
      size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    } while (size > 1 || size < 0.1);
    for (double& c : q) c /= size;
    const double scale = std::pow(10.0, random.uniform(-6, 6));
    const Vec3 shift{random.uniform() * scale, random.uniform() * scale, random.uniform() * scale};
    const auto turned = [&](const Vec3& v) { return rotated(q, {v[0], v[1], m % 2 == 0 ? v[2] : -v[2]}); };
    Surface moved;
    for (const Vec3& p : s.points) moved.points.push_back(vector::add(vector::scale(turned(p), scale), shift));
    for (const Vec3& n : s.normals) moved.normals.push_back(turned(n));
    const std::vector<Vec3> normals = orient(moved.points).normals;
    EXPECT_EQ(shapes::share_correct(normals, moved.normals), 1) << m;
    std::vector<double> angles;
    for (std::size_t i = 0; i < normals.size(); ++i) angles.push_back(std::acos(std::min(1.0, vector::dot(normals[i], turned(still[i])))));
    std::sort(angles.begin(), angles.end());
    EXPECT_LT(angles[angles.size() / 2], 1e-3) << m;
    EXPECT_LT(angles[angles.size() * 99 / 100], 0.03) << m;
    EXPECT_LT(angles.back(), 0.2) << m;
  }
}

}  // namespace
}  // namespace g3r
