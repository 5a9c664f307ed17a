// The library in one page: points in an array of the caller, normals and a mesh out. Here the points are on a sphere, so the truth is
// known: the program fails if a normal points inward.
#include <g3r/g3r.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

int main() {
  constexpr int kPoints = 2000;
  std::vector<double> xyz;  // N x 3, row-major
  for (int i = 0; i < kPoints; ++i) {
    const double z = 1 - (2 * i + 1.0) / kPoints, ring = std::sqrt(1 - z * z), angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    xyz.insert(xyz.end(), {ring * std::cos(angle), ring * std::sin(angle), z});
  }

  try {
    const g3r::PointsView points(xyz.data(), kPoints);
    const g3r::Orientation result = g3r::orient(points);
    int outward = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const g3r::Vec3 p = points[i], n = result.normals[i];
      outward += p[0] * n[0] + p[1] * n[1] + p[2] * n[2] > 0 ? 1 : 0;
    }
    std::printf("%d of %d normals point outward, mean confidence %.2f\n", outward, kPoints, result.stats.confidence_mean);
    return outward == kPoints ? 0 : 1;
  } catch (const g3r::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
