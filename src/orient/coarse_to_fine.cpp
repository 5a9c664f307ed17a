#include "orient/coarse_to_fine.h"

#include "solve/energy_system.h"
#include "solve/green_system.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace g3r {
namespace {

constexpr std::size_t kThinning = 4;  // points per coarse point: twice the spacing
constexpr double kSpacingRatio = 2;
constexpr std::size_t kFewestCoarsePoints = 10000;  // a coarser start costs sides on thin parts and saves little
constexpr double kCoarseShare = 0.2;                // of the progress bar

// Scales the winding gradient to areas: linear up to the median length, constant beyond.
void scale_to_areas(const std::vector<Vec3>& coarse_eta, std::vector<Vec3>& start) {
  double area = 0;
  for (const Vec3& v : coarse_eta) area += std::hypot(v[0], v[1], v[2]);
  area /= static_cast<double>(start.size());
  std::vector<double> lengths(start.size());
  for (std::size_t i = 0; i < start.size(); ++i) lengths[i] = std::hypot(start[i][0], start[i][1], start[i][2]);
  std::vector<double> sorted = lengths;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double scale = lengths[i] > 0 ? area / std::max(lengths[i], *middle) : 0;
    for (double& c : start[i]) c *= scale;
  }
}

Settings coarser(Settings settings) {
  settings.epsilon *= kSpacingRatio;
  settings.refinement_width *= kSpacingRatio;
  settings.winding_weight *= kSpacingRatio;
  settings.damping /= kSpacingRatio;
  return settings;
}

// The start for `points` from a quarter of them, or nothing when there are too few.
std::vector<Vec3> coarse_start(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                               Stages& stages) {
  if (!settings.coarse_to_fine || points.size() / kThinning < kFewestCoarsePoints) return {};
  std::vector<Vec3> some;
  std::vector<std::uint64_t> codes;
  for (std::size_t i = kThinning / 2; i < points.size(); i += kThinning) {
    some.push_back(points[i]);
    codes.push_back(morton[i]);
  }
  const Settings coarse = coarser(settings);
  const std::vector<Vec3> eta = solve_coarse_to_fine(some, codes, coarse, stages).eta;
  const FastSum sum(some, codes, Widths(coarse.refinement_width), coarse.sums, stages.cancel());
  std::vector<Vec3> start = sum.winding_gradient_at(eta, points, stages.cancel());
  scale_to_areas(eta, start);
  return start;
}

}  // namespace

IterativeResult solve_coarse_to_fine(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                                     Stages& stages) {
  const std::vector<Vec3> start = coarse_start(points, morton, settings, stages);
  FastSum sum(points, morton, Widths(settings.epsilon), settings.sums, stages.cancel());
  std::unique_ptr<LinearSystem> system;
  if (settings.method == Method::kGreen) {
    system = std::make_unique<GreenSystem>(sum, points, settings.harmonics, settings.constant_weight);
  } else {
    system = std::make_unique<EnergySystem>(sum, settings.damping, settings.winding_weight);
  }
  const double before = start.empty() ? 0 : kCoarseShare;
  const double share = 1 - before;
  return solve_iteratively(*system, start.empty() ? settings.schedule : settings.continued_schedule, settings.tolerance, start,
                           [&](int step, int steps, double) { stages.progress(before + share * step / steps); });
}

}  // namespace g3r
