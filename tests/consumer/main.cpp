// Points on a sphere through the public headers: the normals must point outward, and errors must cross the library's border.
#include <g3r/eigen.h>
#include <g3r/g3r.h>
#include <g3r/io.h>
#include <g3r/metrics.h>
#include <g3r/view.h>

#include <cmath>
#include <cstdio>

int main() {
  constexpr int kCount = 500;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> points(kCount, 3);
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1.0) / kCount, r = std::sqrt(1 - z * z), turn = 2.399963 * i;
    points.row(i) << r * std::cos(turn), r * std::sin(turn), z;
  }
  const g3r::Orientation orientation = g3r::orient(g3r::points_view(points));
  const auto normals = g3r::as_matrix(orientation.normals);
  const double least = (normals.array() * points.array()).rowwise().sum().minCoeff();
  std::printf("g3r %s: least cosine %.3f\n", g3r::version().data(), least);
  try {
    (void)g3r::orient(g3r::PointsView(points.data(), 2));
    return 1;
  } catch (const g3r::InvalidInput& error) {
    std::printf("as it should: %s\n", error.what());
  }
  return least > 0.8 ? 0 : 1;
}
