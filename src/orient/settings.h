// Options, where given, and the preset's values scaled to the cloud, where not.
#pragma once

#include "cloud/canonical_cloud.h"
#include "cloud/constants.h"
#include "orient/steps.h"
#include "solve/harmonics.h"
#include "solve/iterative_solver.h"
#include "sum/sum_plan.h"

#include <g3r/g3r.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace g3r {

/// Width of kernels that hide single points and what noise scatters them.
struct KernelWidth {
  double points = 0;  ///< width that hides single points at the typical spacing; elsewhere it is in proportion to the local one
  double noise = 0;   ///< width that hides the noise at the typical spacing, 0 without noise
  double power = 0;   ///< the power of the local spacing that `noise` is in proportion to elsewhere

  /// The width where the points are `relative` times as far apart as is typical: the larger of the two.
  [[nodiscard]] double at(double relative) const { return std::max(points * relative, noise * std::pow(relative, power)); }
  [[nodiscard]] double typical() const { return at(1); }
};

/// What polish() goes by, in normalised units.
struct PolishSettings {
  int steps = 0;              ///< of conjugate gradients; 0: no polish
  KernelWidth epsilon;        ///< of the equations
  double damping = 0;         ///< of the equations
  double winding_weight = 0;  ///< of the equations, length^3
  double tolerance = 0;       ///< relative residual at which the steps end earlier
  KernelWidth width;          ///< of the refinement after them
};

/// Everything orient() needs to know, in normalised units. Values without an option are explained in docs/math.md.
struct Settings {
  StepSet without;  ///< steps_left_out()
  Method method = Method::kEnergy;
  bool dense = false;
  bool condition_number = false;    ///< of the dense system, whose matrix it takes once more
  std::vector<Harmonic> harmonics;  ///< green only
  double winding_weight = 0;        ///< energy: l, length^3
  double spacing = 0;
  double noise = 0;  ///< that the widths are made for, 0 when clean
  KernelWidth epsilon;
  KernelWidth coarsest_epsilon;  ///< of the first solve, at its own spacing: without a start a wider one does better
  KernelWidth refinement_width;  ///< 0: no refinement
  double cluster_side = 0;       ///< energy: solve on clusters of points of this size; 0: on the points
  bool coarse_to_fine = false;   ///< start from a solution on fewer points
  PolishSettings polish;
  std::vector<Steps> schedule;            ///< from eta = 0
  std::vector<Steps> continued_schedule;  ///< from a coarse solution
  std::vector<Steps> doubtful_schedule;   ///< after it, where many sides are unsure, of width coarsest_epsilon; empty: never
  double unsure_of_noise = 0;             ///< share of the points whose sides noise alone makes unsure
  std::string schedule_text;
  double tolerance = 0;            ///< stop at this relative residual
  double continued_tolerance = 0;  ///< the same after a start from a coarse solution
  double doubtful_tolerance = 0;   ///< the same of the steps where many sides are unsure
  double start_tolerance = 0;      ///< the same for a solution that is only a start
  double accepted_residual = 0;    ///< at or below this the result counts as converged
  double accuracy = 0;             ///< of the sums
  SumPlan first_sums;              ///< of the solve from eta = 0
  SumPlan sums;                    ///< of everything after it
};

/// The steps that a run is without: those that options leave out, and those that its method or preset would run but has not (what comes
/// after kPolish goes with it). Throws InvalidInput.
[[nodiscard]] StepSet steps_left_out(const Options& options);

/// The noise of options in the cloud's frame, if it is given. Throws InvalidInput below 0.
[[nodiscard]] std::optional<double> given_noise(const Length& noise, const CanonicalCloud& cloud, double spacing);

/// `spacing`, `noise`: lengths in the cloud's frame, the latter given_noise() or estimate_noise(); `outlier_share`: of all points, those
/// that find_outliers() took out. Throws InvalidInput for an option out of range, naming it and the range.
[[nodiscard]] Settings choose_settings(const Options& options, const CanonicalCloud& cloud, double spacing, double noise,
                                       double outlier_share);

/// The paper's mollifier for clean input: 0.8 x the leaf side of an octree with at most one point per leaf, at its deepest level.
[[nodiscard]] double paper_epsilon(const CanonicalCloud& cloud);

/// Width in spacings of the kernels of a solve with a start, and of least squares: narrower converges slower, wider blurs thin walls.
inline constexpr double kEpsilon = 0.4;
/// Width in spacings of the winding gradient that solves end with, and that finer ones start from: the field of the solution seen through
/// the kernels of the solve once more, whose variances add. Narrower is noisy, wider rounds edges.
inline constexpr double kRefinementWidth = std::numbers::sqrt2 * kEpsilon;
/// Accuracy of the sums of a solve that has a start: it gives the same normals with 2e-2 as with 1e-3, while one from 0 amplifies errors
/// with every step, and asks for half of it.
inline constexpr double kContinuedAccuracy = 2e-2;
/// Points of a coarse cloud, at least: fewer cost sides on thin parts, lose small open ones, and save little.
inline constexpr std::size_t kFewestCoarsePoints = 10000;
/// Where sides are unsure, around them or around facets, at most: 20 to 40 are enough as a rule.
inline constexpr Steps kMoreSteps{60, StepKind::kConjugateGradient};
/// Steps in which what is known reaches the far sides: fewer leave those undecided. More fit what is wrong with the equations: noise, above
/// all in the polish, and after a coarse start, where smooth shapes take 2 to 10, open surfaces and the outliers that are always left.
inline constexpr int kFewSteps = 10;
/// Weight l of the winding number, in h^3, so that S eta and l W^T W eta keep their proportion for any number of points, of a solve with a
/// start, among outliers, and of further steps: more costs sides of thin walls, less costs narrow gaps.
/// From eta = 0 it is that of lengths kLevelRatio times as long: more converges slower, none loses nested shells.
/// Of the polish: kPolishWindingWeight (noise_settings.h).
inline constexpr double kWindingWeight = 30;

/// Whether solve_coarse_to_fine() begins with fewer points.
[[nodiscard]] bool starts_coarse(const Settings& settings, std::size_t points);

}  // namespace g3r
