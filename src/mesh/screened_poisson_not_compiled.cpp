#include "mesh/screened_poisson.h"

#include <g3r/error.h>

namespace g3r {

bool screened_poisson_available() { return false; }

void require_screened_poisson() {
  throw Unavailable(
      "built without Open3D, so there is no screened Poisson mesher: use the field mesher, or configure with -DG3R_WITH_OPEN3D=ON");
}

Mesh screened_poisson(const std::vector<Vec3>&, const std::vector<Vec3>&, int) {
  require_screened_poisson();
  return {};
}

}  // namespace g3r
