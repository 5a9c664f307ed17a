#include "orient/walls.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/noise.h"
#include "cloud/quadratic_patch.h"
#include "cloud/some_places.h"
#include "cpu/parallel.h"
#include "orient/projection.h"
#include "orient/same_side.h"

#include <cstddef>
#include <cstdint>

namespace g3r {

PlacesOnWalls fit_places(const PointSet& set, const std::vector<Vec3>& normals, double noise, double spacing) {
  const double reach = projection_reach(noise, spacing);
  const SomePlaces some = SomePlaces::at_most(kPlaces, set.size());
  PlacesOnWalls places{std::vector<Vec3>(some.size()), std::vector<double>(some.size(), -1)};
  parallel::for_all(some.size(), [&](std::size_t k) {
    const std::size_t i = some[k];
    places.normals[k] = normals[i];
    SameSide side(set.points(), set.tree(), normals);
    side.gather(i, to_eigen(normals[i]), reach, kSigmas * noise);
    if (side.members().size() < kPerTerm * kQuadraticTerms) return;
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

MeanExcess excess_about_walls(const PointSet& set, const std::vector<Vec3>& normals, double noise, double spacing) {
  const double reach = kLevelRatio * projection_reach(noise, spacing);
  const double depth = kNoiseBreadth * noise;
  const Vec3 steps = set.rounding_steps();
  const SomePlaces some = SomePlaces::at_most(kPlaces, set.size());
  std::vector<HeightMoments> at(some.size());
  std::vector<std::size_t> held(at.size(), 0);
  parallel::for_all(at.size(), [&](std::size_t k) {
    const std::size_t i = some[k];
    SameSide side(set.points(), set.tree(), normals);
    side.gather(i, to_eigen(normals[i]), reach, depth);
    const std::vector<std::uint32_t>& members = side.indices();
    if (members.size() < kPerTerm * kCubicTerms) return;
    at[k] = height_moments(set.points(), members.data(), members.size(), normals[i], spacing, steps);
    held[k] = members.size();
  });
  std::vector<HeightMoments> places;
  std::size_t members = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (held[k] == 0) continue;
    places.push_back(at[k]);
    members += held[k];
  }
  if (places.empty()) return {};
  const double neighbourhood = static_cast<double>(members) / static_cast<double>(places.size());
  return mean_excess(places, static_cast<double>(set.size()) / neighbourhood);
}

}  // namespace g3r
