#include "orient/projection.h"

#include "base/median.h"
#include "base/vector.h"
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

double projection_reach(double noise, double spacing) { return kNarrowestReach / std::numbers::sqrt2 * std::sqrt(noise * spacing); }

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
      if (side.members().size() < 2 * kQuadraticTerms) continue;
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

PlacesOnWalls fit_places(const PointSet& set, const std::vector<Vec3>& normals, double noise, double spacing) {
  const double reach = projection_reach(noise, spacing);
  const std::size_t stride = 1 + set.size() / kPlaces;
  const std::size_t count = (set.size() + stride - 1) / stride;
  PlacesOnWalls places{std::vector<Vec3>(count), std::vector<double>(count, -1)};
  parallel::for_all(count, [&](std::size_t k) {
    const std::size_t i = k * stride;
    places.normals[k] = normals[i];
    SameSide side(set.points(), set.tree(), normals);
    side.gather(i, to_eigen(normals[i]), reach, kSigmas * noise);
    if (side.members().size() < 2 * kQuadraticTerms) return;
    const double found = residual(fit_quadratic_patch(side.members(), 0, reach / 2, 0), side.members()) / noise;
    if (found >= 0) places.residuals[k] = found;
  });
  return places;
}

double misfit(const PlacesOnWalls& places) {
  std::vector<double> residuals = places.residuals;
  std::erase_if(residuals, [](double r) { return r < 0; });
  return residuals.empty() ? 1 : median(std::move(residuals));
}

double turned_share(const PlacesOnWalls& before, const PlacesOnWalls& after) {
  std::size_t both = 0;
  std::size_t turned = 0;
  for (std::size_t k = 0; k < before.residuals.size(); ++k) {
    if (before.residuals[k] < 0 || after.residuals[k] < 0) continue;
    ++both;
    turned += vector::dot(before.normals[k], after.normals[k]) < 0 ? 1 : 0;
  }
  return both == 0 ? 0 : static_cast<double>(turned) / static_cast<double>(both);
}

}  // namespace g3r
