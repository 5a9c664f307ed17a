#include "orient/open_to_views.h"

#include "base/vector.h"
#include "orient/noise_settings.h"
#include "orient/sight_normals.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace g3r {

void open_to_views(const Views& views, const std::vector<Vec3>& points, Solution& solution) {
  OpenSurfaces& surfaces = solution.open_surfaces;
  std::vector<Vec3>& normals = solution.refinement.normals;
  const std::size_t n = points.size();
  surfaces.resize(n);
  surfaces.certified.resize(n, 1);
  solution.turned_to_views.assign(n, 0);
  std::uint32_t part = OpenSurfaces::kNone;  // as all parts, by its first point
  for (std::uint32_t i = 0; i < n; ++i) {
    if (surfaces.part[i] != OpenSurfaces::kNone) continue;
    if (part == OpenSurfaces::kNone) part = i;
    const double cosine = vector::dot(normals[i], vector::normalised(vector::subtract(views.place_of(i), points[i])));
    if (cosine < 0) {
      normals[i] = vector::scale(normals[i], -1);
      solution.eta[i] = vector::scale(solution.eta[i], -1);
      solution.turned_to_views[i] = 1;
    }
    surfaces.part[i] = part;
    surfaces.certainty[i] = 1;
    surfaces.certified[i] = static_cast<float>((1 + std::abs(cosine)) / 2);
    surfaces.agrees[i] = 1;
  }
}

bool is_seen_in_noise(const Problem& problem) {
  const bool is_ours = problem.settings.method == Method::kEnergy && !problem.is_lines();
  return is_ours && runs(problem, Step::kPolish) && problem.cloud.set.views().known() &&
         problem.direction_noise > noise_of_clean_widths() * problem.spacing;
}

Solution solve_by_sight(const Problem& problem, Stages& stages, Stats& stats) {
  stages.begin("solve");
  const PointSet& set = problem.cloud.set;
  SightNormals seen = normals_by_sight(set, {problem.direction_noise, problem.noise_together}, stages.cancel());
  Solution out;
  out.refinement.normals = std::move(seen.normals);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const double h = set.local_spacing()[i];
    out.eta.push_back(vector::scale(out.refinement.normals[i], h * h));
  }
  out.open_surfaces.part.assign(set.size(), 0);
  out.open_surfaces.certainty.assign(set.size(), 1);
  out.open_surfaces.certified = std::move(seen.certified);
  out.open_surfaces.agrees.assign(set.size(), 1);
  out.open_surfaces.held.assign(set.size(), 1);
  stats.converged = true;
  return out;
}

}  // namespace g3r
