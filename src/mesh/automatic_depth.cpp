#include "mesh/screened_poisson.h"

#include <g3r/names.h>

#include <algorithm>
#include <cmath>

namespace g3r {

int automatic_depth(double spacing, double box_side) {
  const double depth = std::round(std::log2(kPoissonCube * box_side / spacing));
  if (!(depth > kLeastMeshDepth)) return kLeastMeshDepth;  // also for a ratio that is no number
  return static_cast<int>(std::min<double>(depth, kMostAutomaticDepth));
}

}  // namespace g3r
