#include "solve/refine.h"

#include "base/vector.h"
#include "cpu/parallel.h"

#include <cmath>
#include <utility>

namespace g3r {

std::vector<Vec3> normalised(const std::vector<Vec3>& eta) {
  std::vector<Vec3> out(eta.size());
  parallel::for_all(eta.size(), [&](std::size_t i) {
    const double size = vector::length(eta[i]);
    out[i] = size > 0 ? Vec3{eta[i][0] / size, eta[i][1] / size, eta[i][2] / size} : Vec3{0, 0, 1};
  });
  return out;
}

Refinement refine_normals(FastSum& sum, const std::vector<Vec3>& eta) {
  Refinement refined = unit_normals(sum.winding_gradient(eta), eta);
  parallel::for_all(refined.strength.size(), [&](std::size_t i) { refined.strength[i] *= sum.width(i); });
  return refined;
}

Refinement unit_normals(std::vector<Vec3> gradients, const std::vector<Vec3>& eta) {
  Refinement refined;
  refined.normals = std::move(gradients);
  refined.strength.resize(eta.size());
  parallel::for_all(eta.size(), [&](std::size_t i) {
    Vec3& n = refined.normals[i];
    const double size = vector::length(n);
    refined.strength[i] = size;
    if (size > 0) {
      for (double& c : n) c /= size;
    } else {
      n = normalised({eta[i]}).front();
    }
  });
  return refined;
}

}  // namespace g3r
