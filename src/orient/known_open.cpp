#include "orient/known_open.h"

#include "base/vector.h"
#include "cloud/sites.h"
#include "orient/agreement.h"
#include "orient/clean_surface.h"
#include "orient/site_parts.h"

#include <cstddef>
#include <numeric>

namespace g3r {

std::vector<std::uint32_t> known_open_points(const Problem& problem) {
  const std::size_t all = problem.cloud.size();
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < problem.known.open.size(); ++i) {
    if (problem.known.open[i] != 0) some.push_back(i);
  }
  if (some.size() < kFewestSites) return {};
  if (all - some.size() < kFewestSites) {
    some.resize(all);
    std::iota(some.begin(), some.end(), std::uint32_t{0});
  }
  return some;
}

Solution as_known_open(const Problem& problem, Stages& stages) {
  const PointSet& set = problem.cloud.set;
  const std::size_t all = set.size();
  stages.begin("refine");
  const Sites sites = place_sites(set, site_distance(all, set.spacing(), problem.noise), stages.cancel());
  Solution solution;
  std::vector<Vec3>& normals = solution.refinement.normals;
  normals = sides_as_known(set, sites, problem.known.gradient, problem.settings.sums, stages.cancel());
  solution.refinement.strength.assign(all, 1);
  if (problem.is_clean()) fit_directions(problem, normals);
  const std::vector<double>& spacing = set.local_spacing();
  for (std::size_t i = 0; i < all; ++i) solution.eta.push_back(vector::scale(normals[i], spacing[i] * spacing[i]));
  OpenSurfaces& surfaces = solution.open_surfaces;
  surfaces.part.assign(all, 0);
  surfaces.certainty.assign(all, kUndecided);
  surfaces.certified.assign(all, 1);
  surfaces.agrees.assign(all, 1);
  surfaces.held.assign(all, 1);
  return solution;
}

}  // namespace g3r
