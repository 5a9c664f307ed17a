#include "orient/refine.h"

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

constexpr double kFullSize = 0.5;  // share of the median |eta| from which the size no longer lowers the confidence

double length(const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

std::vector<Vec3> normalised(const std::vector<Vec3>& eta) {
  std::vector<Vec3> out(eta.size());
  for (std::size_t i = 0; i < eta.size(); ++i) {
    const double size = length(eta[i]);
    out[i] = size > 0 ? Vec3{eta[i][0] / size, eta[i][1] / size, eta[i][2] / size} : Vec3{0, 0, 1};
  }
  return out;
}

Refinement refine_normals(FastSum& sum, const std::vector<Vec3>& eta) {
  Refinement refined;
  refined.normals = sum.winding_gradient(eta);
  refined.strength.resize(eta.size());
  for (std::size_t i = 0; i < eta.size(); ++i) {
    Vec3& n = refined.normals[i];
    const double size = length(n);
    refined.strength[i] = size;
    if (size > 0) {
      for (double& c : n) c /= size;
    } else {
      n = normalised({eta[i]}).front();
    }
  }
  return refined;
}

std::vector<float> side_confidence(const std::vector<Vec3>& eta, const std::vector<Vec3>& normals) {
  std::vector<double> sizes(eta.size());
  for (std::size_t i = 0; i < eta.size(); ++i) sizes[i] = length(eta[i]);
  std::vector<double> sorted = sizes;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double full = kFullSize * *middle;
  std::vector<float> confidence(eta.size(), 0.0F);
  for (std::size_t i = 0; i < eta.size(); ++i) {
    if (!(sizes[i] > 0)) continue;
    const double cosine = (eta[i][0] * normals[i][0] + eta[i][1] * normals[i][1] + eta[i][2] * normals[i][2]) / sizes[i];
    const double agreement = std::clamp((1 + cosine) / 2, 0.0, 1.0);
    confidence[i] = static_cast<float>(agreement * std::min(1.0, sizes[i] / full));
  }
  return confidence;
}

}  // namespace g3r
