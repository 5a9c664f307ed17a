#include "mesh/screened_poisson.h"

#include <algorithm>
#include <cmath>

namespace g3r {

namespace {

// The octree's cube is this much wider than the box of the points.
constexpr double kCubePerBox = 1.1;
// Deeper than this costs minutes and gigabytes, which nobody asked for by default.
constexpr int kMaxAutomaticDepth = 10;

}  // namespace

int automatic_depth(double spacing, double box_side) {
  const double depth = std::round(std::log2(kCubePerBox * box_side / spacing));
  if (!(depth > kMinPoissonDepth)) return kMinPoissonDepth;  // also for a ratio that is no number
  return static_cast<int>(std::min<double>(depth, kMaxAutomaticDepth));
}

}  // namespace g3r
