#include "orient/projection.h"

#include "cloud/constants.h"
#include "cloud/quadratic_patch.h"
#include "cpu/parallel.h"
#include "orient/noisy_jets.h"
#include "orient/same_side.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace g3r {
namespace {

using Eigen::Vector3d;

bool is_in_box(const Vector3d& p) { return p.cwiseAbs().maxCoeff() <= 1; }

}  // namespace

double projection_reach(double noise, double spacing) { return kNoiseReach * std::sqrt(noise * spacing); }

double projected_noise(double noise, double spacing) {
  const double kernel = std::sqrt(72 / (15 * std::numbers::pi));
  return std::min(noise, kernel * noise * spacing / projection_reach(noise, spacing));
}

std::vector<Vec3> project_points(const std::vector<Vec3>& points, const Neighbours& tree, const std::vector<Vec3>& normals, double noise,
                                 const std::vector<double>& spacing, const std::atomic<bool>* cancel) {
  const double farthest = kSigmas * noise;
  std::vector<Vec3> out = points;
  const auto project_block = [&](std::size_t begin, std::size_t end) {
    SameSide side(points, tree, normals);
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d normal = to_eigen(normals[i]);
      const double reach = projection_reach(noise, spacing[spacing.size() == 1 ? 0 : i]);
      side.gather(i, normal, reach, farthest);
      if (side.members().size() < kPerTerm * kQuadraticTerms) continue;
      Vector3d above;
      const double height = fit_quadratic_patch(side.members(), 0, reach / 2, 0).distance(Vector3d::Zero(), &above);
      if (!(above.dot(normal) > kSameSide)) continue;
      const Vector3d there = to_eigen(points[i]) - std::clamp(height, -farthest, farthest) * above;
      if (is_in_box(there)) out[i] = {there[0], there[1], there[2]};
    }
  };
  parallel::for_blocks(points.size(), parallel::kSmallBlock, project_block, cancel);
  return out;
}

}  // namespace g3r
