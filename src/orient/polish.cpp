#include "orient/polish.h"

#include "base/median.h"
#include "cloud/constants.h"
#include "cpu/parallel.h"
#include "orient/crowded.h"
#include "solve/energy_system.h"
#include "solve/iterative_solver.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r {
Widths local_widths(const KernelWidth& width, const Settings& settings, const std::vector<double>& spacing) {
  if (spacing.empty()) return Widths(width.typical());
  std::vector<double> widths(spacing.size());
  parallel::for_all(widths.size(), [&](std::size_t i) {
    const double relative = spacing[i] / settings.spacing;
    // Kernels that hide noise everywhere would hold a whole crowd.
    widths[i] = narrowing(relative) < 1 ? relative * width.typical() : width.at(relative);
  });
  return Widths(std::move(widths));
}

void gradient_to_areas(FastSum& sum, const std::vector<double>& areas, std::vector<Vec3>& gradient) {
  std::vector<double> lengths(gradient.size());
  parallel::for_all(gradient.size(), [&](std::size_t i) { lengths[i] = std::hypot(gradient[i][0], gradient[i][1], gradient[i][2]); });
  const double middle = median(lengths);
  parallel::for_all(gradient.size(), [&](std::size_t i) {
    const double scale = lengths[i] > 0 ? areas[areas.size() == 1 ? 0 : i] / std::max(lengths[i], middle) : 0;
    for (double& c : gradient[i]) c *= scale;
  });
  const double winding = median(sum.winding(gradient));
  // Of a flat surface W eta is rounding, which says nothing of lengths.
  const double factor = winding > kRidge ? 0.5 / winding : 1;
  parallel::for_all(gradient.size(), [&](std::size_t i) {
    for (double& c : gradient[i]) c *= factor;
  });
}

std::vector<double> point_areas(const Settings& settings, const std::vector<double>& spacing) {
  if (spacing.empty()) return {settings.spacing * settings.spacing};
  std::vector<double> areas = spacing;
  for (double& a : areas) a *= a;
  return areas;
}

Polished polish(PolishCloud cloud, const Settings& settings, Refinement refined, Stages& stages) {
  FastSum wider(cloud.points, local_widths(settings.polish.width, settings, cloud.spacing), settings.sums, stages.cancel());
  FastSum sum(wider, local_widths(settings.polish.epsilon, settings, cloud.spacing));
  EnergySystem system(sum, settings.polish.damping, settings.polish.winding_weight, cloud.roots);
  std::vector<double>().swap(cloud.spacing);
  std::vector<Vec3> start = std::move(refined.normals);
  for (std::size_t i = 0; i < start.size(); ++i) {
    for (double& c : start[i]) c *= refined.strength[i];
  }
  std::vector<double>().swap(refined.strength);
  gradient_to_areas(sum, cloud.areas, start);
  std::vector<double>().swap(cloud.areas);
  const std::vector<Steps> schedule{{settings.polish.steps, StepKind::kConjugateGradient}};
  const auto still_going = [&stages](int, int, double) { stages.still_going(); };
  Polished polished;
  polished.eta =
      system.to_areas(solve_iteratively(system, schedule, settings.polish.tolerance, system.from_areas(std::move(start)), still_going).eta);
  polished.refinement = refine_normals(wider, polished.eta);
  return polished;
}

}  // namespace g3r
