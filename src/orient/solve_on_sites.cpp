#include "orient/solve_on_sites.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/sites.h"
#include "orient/open_surfaces.h"
#include "orient/solve_apart.h"
#include "solve/refine.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

Solution solve_on_sites(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const std::vector<Vec3>& points = problem.cloud.points();
  const Sites sites = place_sites(problem.cloud.set, problem.line_distance);
  const Problem coarse = on_sites(problem, sites, options);
  const Solution solved = solve_parts(coarse, options, stages, stats);
  Solution out;
  out.open_surfaces.uncertified = solved.open_surfaces.uncertified;
  out.eta.resize(points.size());
  std::vector<double> members(sites.size(), 0);
  for (const std::uint32_t s : sites.site_of) ++members[s];
  std::vector<std::uint32_t> first(sites.size(), OpenSurfaces::kNone);  // point of every part
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::uint32_t s = sites.site_of[i];
    out.eta[i] = vector::scale(solved.eta[s], 1 / members[s]);
    if (!solved.open_surfaces.certified.empty()) out.open_surfaces.certified.push_back(solved.open_surfaces.certified[s]);
    if (solved.open_surfaces.part.empty()) continue;
    const std::uint32_t part = solved.open_surfaces.part[s];
    if (part != OpenSurfaces::kNone) first[part] = std::min(first[part], i);
    out.open_surfaces.part.push_back(part == OpenSurfaces::kNone ? part : first[part]);
    out.open_surfaces.certainty.push_back(solved.open_surfaces.certainty[s]);
    out.open_surfaces.agrees.push_back(solved.open_surfaces.agrees[s]);
    out.open_surfaces.held.push_back(solved.open_surfaces.held[s]);
  }
  const FastSum field(sites.points(), Widths(kBetweenSites * coarse.spacing), coarse.settings.sums, stages.cancel());
  out.refinement = unit_normals(field.winding_gradient_at(solved.eta, points, stages.cancel()), out.eta);
  return out;
}

}  // namespace g3r
