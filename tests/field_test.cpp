// Field: the winding field of oriented points, anywhere, in the units of the caller.
#include <g3r/g3r.h>

#include "shapes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

TEST(Field, IsOneInsideAndZeroOutside) {
  const Surface s = shapes::sphere(8000, 2, {10, 20, 30});
  Orientation o;
  o.normals = s.normals;
  o.areas = s.areas;
  const Field field(s.points, o);
  const std::vector<Vec3> queries{{10, 20, 30}, {10.5, 20, 29}, {13, 20, 30}, {100, 20, 30}, {10, 22, 30}};
  const std::vector<double> w = field.value(queries);
  EXPECT_NEAR(w[0], 1, 5e-3);
  EXPECT_NEAR(w[1], 1, 5e-3);
  EXPECT_NEAR(w[2], 0, 5e-3);
  EXPECT_NEAR(w[3], 0, 5e-3);
  EXPECT_NEAR(w[4], 0.5, 0.1);
  const std::vector<double> alone = field.value(std::vector<Vec3>{queries[1]});
  EXPECT_EQ(alone[0], w[1]);  // a query's value does not depend on the others
}

// In the units of the caller, near the surface and far away, by differences of the field itself.
TEST(Field, GradientIsTheDerivativeOfTheValue) {
  for (const double size : {1e-3, 2.0, 5e4}) {
    const Surface s = shapes::sphere(1500, size, {10 * size, -20 * size, 3 * size});
    Orientation o;
    o.normals = s.normals;
    o.areas = s.areas;
    const Field field(s.points, o, 0.4 * size);
    const double step = 0.02 * size;
    for (const Vec3& at : {Vec3{0, 0, 1.1}, Vec3{0.5, 0.5, 0.3}, Vec3{-0.7, 0.9, 0}, Vec3{0, -0.9, 0.2}}) {
      const Vec3 x{(10 + at[0]) * size, (-20 + at[1]) * size, (3 + at[2]) * size};
      std::vector<Vec3> beside;
      for (std::size_t a = 0; a < 3; ++a) {
        for (const double side : {-step, step}) {
          beside.push_back(x);
          beside.back()[a] += side;
        }
      }
      const std::vector<double> w = field.value(beside);
      const Vec3 g = field.gradient(std::vector<Vec3>{x})[0];
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR((w[2 * a + 1] - w[2 * a]) / (2 * step) * size, g[a] * size, 5e-3) << size;
    }
  }
}

TEST(Field, LeavesOutWhatIsNotFinite) {
  const Surface s = shapes::sphere(2000);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Orientation o;
  o.normals = s.normals;
  o.areas = s.areas;
  o.normals[3][1] = kNan;
  o.areas[7] = kNan;
  o.areas[9] = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(Field(s.points, o).value(std::vector<Vec3>{{0, 0, 0}})[0], 1, 0.02);
  o.areas.pop_back();
  try {
    (void)Field(s.points, o);
    FAIL() << "fewer areas than points";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("1999 areas"), std::string::npos);
  }
}

}  // namespace
}  // namespace g3r
