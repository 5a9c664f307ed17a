#include "mesh/screened_poisson.h"

#include <g3r/names.h>

#include <algorithm>
#include <cmath>

namespace g3r {

namespace {

// The largest depth that is chosen without being asked for: more costs minutes and gigabytes.
constexpr int kMaxAutomaticDepth = 10;

}  // namespace

int automatic_depth(double spacing, double box_side) {
  const double depth = std::round(std::log2(kPoissonCube * box_side / spacing));
  if (!(depth > kLeastMeshDepth)) return kLeastMeshDepth;  // also for a ratio that is no number
  return static_cast<int>(std::min<double>(depth, kMaxAutomaticDepth));
}

}  // namespace g3r
