#include "orient/settings.h"

#include "base/vector.h"
#include "baselines/baseline.h"
#include "cloud/chance.h"
#include "cloud/morton.h"
#include "cloud/sites.h"
#include "orient/noise_settings.h"

#include <g3r/error.h>
#include <g3r/names.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>

namespace g3r {
namespace {

// Width in spacings of the kernels of a solve without a start: it converges faster than with kEpsilon, and finds more sides; wider ones
// blur thin walls.
constexpr double kCoarsestEpsilon = 0.5;
// Relative residual at which solves from eta = 0, further steps and least squares stop: slats and spokes need so little, smooth shapes get
// there in half of the steps of the schedule.
constexpr double kTolerance = 2.5e-3;
// Steps of the energy form from eta = 0, at most: slats need as many, smooth shapes stop at half.
constexpr const char* kEnergySchedule = "45 cg";
// Steps of least squares over the harmonics: more cost time, and change sides for better and worse.
constexpr const char* kGreenSchedule = "20 cg";
// Relative residual up to which a solve counts as converged: random points on spheres end at 0.05 after a coarse start, with normals right
// to 1e-4.
constexpr double kAcceptedResidual = 0.1;
// Steps of the polish of clean points: narrow gaps want more, smooth shapes fewer.
constexpr int kPolishSteps = 5;
// The paper's width of the mollifier, in sides of its smallest leaves.
constexpr double kPaperLeafFactor = 0.8;
// The least of it in spacings: below, 80 iterations are far from converged, as random samples have very close pairs.
constexpr double kPaperLeastEpsilon = 0.15;
// The paper's iterations.
constexpr const char* kPaperSchedule = "20 sd 60 cg";
// Points up to which the paper preset takes the dense solver, the paper's "small N": it takes seconds with so many, and minutes with more.
constexpr std::size_t kPaperDensePoints = 500;
// Highest degree of the harmonics of the method green where none is given.
constexpr int kDefaultDegree = 2;

// A length that is not automatic, in the cloud's frame.
double in_frame(const Length& length, const CanonicalCloud& cloud, double spacing) {
  switch (length.unit) {
    case Length::Unit::kInput:
      return cloud.frame.length_to_unit(length.value);
    case Length::Unit::kPercent: {
      vector::Box box;
      for (const Vec3& p : cloud.points()) box.extend(p);
      const Vec3 diagonal = vector::subtract(box.high, box.low);
      return length.value / 100 * std::hypot(diagonal[0], diagonal[1], diagonal[2]);
    }
    case Length::Unit::kSpacing:
      return length.value * spacing;
    default:
      return length.value;
  }
}

double cube(double x) { return x * x * x; }

void require(bool good, const std::string& message) {
  if (!good) throw InvalidInput(message);
}

Method method_of(const Options& options) {
  if (options.method != Method::kAuto) return options.method;
  const bool harmonics_given = options.degree >= 0 || !options.harmonics.empty();
  return options.preset == Preset::kPaper || harmonics_given ? Method::kGreen : Method::kEnergy;
}

// Throws for options that contradict each other, whatever the cloud.
void require_sound(const Options& options) {
  const bool harmonics_given = options.degree >= 0 || !options.harmonics.empty();
  const bool green = method_of(options) == Method::kGreen;
  require(!harmonics_given || green, "degree and harmonics belong to the method green; leave them out with energy");
  require(options.degree < 0 || options.harmonics.empty(), "give either a degree or a list of harmonics, not both");
  require(options.degree >= -1 && options.degree <= kMaxHarmonicDegree,
          "degree must be between 0 and " + std::to_string(kMaxHarmonicDegree));
  require(options.threads >= 0, "threads must be 0 (all cores) or positive");
  require(options.tolerance == -1 || (options.tolerance >= 0 && options.tolerance < 1), "tolerance must be in [0, 1)");
  require(options.epsilon.unit == Length::Unit::kAuto || (options.epsilon.value > 0 && std::isfinite(options.epsilon.value)),
          "epsilon must be a positive number");
  const bool paper = options.preset == Preset::kPaper;
  require(options.noise.unit == Length::Unit::kAuto || (method_of(options) == Method::kEnergy && !paper),
          "noise belongs to the method energy of the default preset; leave it out with " +
              (paper ? "the preset paper" : std::string(name_of(method_of(options)))));
  require(options.solver != Solver::kDense || green, "the dense solver belongs to the method green");
}

void choose_equations(const Options& options, std::size_t points, Settings& s) {
  s.method = method_of(options);
  const bool green = s.method == Method::kGreen;
  if (green) {
    s.harmonics = options.harmonics.empty() ? harmonics_of_degrees(0, options.degree >= 0 ? options.degree : kDefaultDegree)
                                            : parse_harmonics(options.harmonics);
  }
  const bool small = options.preset == Preset::kPaper && green && options.schedule.empty() && points <= kPaperDensePoints;
  s.dense = options.solver == Solver::kDense || (options.solver == Solver::kAuto && small);
  s.condition_number = options.condition_number;
  require(!s.condition_number || s.dense, "the condition number is that of the dense system: set the solver to dense");
}

// The widths for clean points, which follow_noise() changes.
void choose_widths(const Options& options, const CanonicalCloud& cloud, Settings& s) {
  const bool paper = options.preset == Preset::kPaper;
  const bool automatic = options.epsilon.unit == Length::Unit::kAuto;
  s.epsilon.points = kEpsilon * s.spacing;
  if (paper) s.epsilon.points = std::max(paper_epsilon(cloud), kPaperLeastEpsilon * s.spacing);
  if (!automatic) s.epsilon.points = in_frame(options.epsilon, cloud, s.spacing);
  s.coarsest_epsilon = s.epsilon;
  if (s.method == Method::kEnergy && automatic) s.coarsest_epsilon.points = kCoarsestEpsilon * s.spacing;
  s.refinement_width.points = paper ? 0 : kRefinementWidth * s.spacing;
  s.polish.epsilon.points = std::min(s.epsilon.points, kEpsilon / kLevelRatio * s.spacing);
  s.polish.width.points = kRefinementWidth / kLevelRatio * s.spacing;
  s.polish.winding_weight = kPolishWindingWeight * cube(s.spacing);
}

void choose_steps(const Options& options, bool among_outliers, Settings& s) {
  const bool paper = options.preset == Preset::kPaper;
  const bool green = s.method == Method::kGreen;
  const bool given = options.tolerance >= 0;
  s.schedule_text = !options.schedule.empty() ? options.schedule : paper ? kPaperSchedule : green ? kGreenSchedule : kEnergySchedule;
  s.schedule = parse_schedule(s.schedule_text);
  s.coarse_to_fine = options.schedule.empty() && !contains(s.without, Step::kCoarseStart);
  s.continued_schedule = {{kFewSteps, StepKind::kConjugateGradient}};
  if (!among_outliers && !contains(s.without, Step::kMoreSteps)) s.doubtful_schedule = {kMoreSteps};
  s.polish.steps = contains(s.without, Step::kPolish) ? 0 : kPolishSteps;
  s.tolerance = given ? options.tolerance : paper ? 0 : kTolerance;
  s.accepted_residual = given ? options.tolerance : kAcceptedResidual;
  // What starts from a solution is no better than its sums, nor is a start, which stands for kTwiceAsFar times as many points as it has.
  s.continued_tolerance = given ? options.tolerance : kContinuedAccuracy;
  s.doubtful_tolerance = given ? options.tolerance : kTolerance;
  s.start_tolerance = std::max(s.tolerance, kTwiceAsFar * kTolerance);
}

void choose_sums(const Options& options, std::size_t points, Settings& s) {
  s.accuracy = options.accuracy != -1 ? options.accuracy : kContinuedAccuracy / kLevelRatio;
  s.first_sums = sum_plan(s.accuracy, points);
  const bool continued = options.accuracy == -1 && s.method == Method::kEnergy;
  s.sums = sum_plan(continued ? kContinuedAccuracy : s.accuracy, points);
}

}  // namespace

StepSet steps_left_out(const Options& options) {
  StepSet out = parse_steps(options.without);
  const auto leave_out = [&out](std::initializer_list<Step> steps) {
    for (const Step step : steps) out.set(static_cast<std::size_t>(step));
  };
  const bool paper = options.preset == Preset::kPaper;
  // What others have published stays as it is.
  if (paper || is_baseline(options.method)) leave_out({Step::kViewpoint, Step::kOutliers, Step::kSites, Step::kPolish, Step::kNoiseChoice});
  if (paper) leave_out({Step::kNoise, Step::kCoarseStart});
  if (method_of(options) != Method::kEnergy) leave_out({Step::kSites, Step::kCoarseStart, Step::kNoiseChoice, Step::kAreas});
  return out;
}

std::optional<double> given_noise(const Length& noise, const CanonicalCloud& cloud, double spacing) {
  if (noise.unit == Length::Unit::kAuto) return std::nullopt;
  require(noise.value >= 0 && std::isfinite(noise.value), "noise must be 0 or a positive number");
  return in_frame(noise, cloud, spacing);
}

// Two points share a leaf of level L when their codes agree in the first 3 L bits; neighbours in Morton order share the most.
double paper_epsilon(const CanonicalCloud& cloud) {
  const std::vector<std::uint64_t> codes = morton_codes(cloud.points());
  int deepest = 0;
  for (std::size_t i = 1; i < cloud.size(); ++i) {
    const int common_bits = std::countl_zero(codes[i - 1] ^ codes[i]) - 1;  // the top bit of a code is unused
    deepest = std::max(deepest, std::min(common_bits / 3 + 1, kGridBits));
  }
  return kPaperLeafFactor * std::ldexp(2.0, -deepest);
}

Settings choose_settings(const Options& options, const CanonicalCloud& cloud, double spacing, double noise, double outlier_share) {
  require_sound(options);
  Settings s;
  s.without = steps_left_out(options);
  s.spacing = spacing;
  // Clean clouds lose one point, very uneven ones 0.6 %.
  const bool among_outliers = outlier_share > kFalseAlarms;
  choose_equations(options, cloud.size(), s);
  choose_widths(options, cloud, s);
  choose_steps(options, among_outliers, s);
  // An epsilon as wide as a scale of fewer points, asked for, is taken to mean noise.
  const bool wide = s.epsilon.points > kFirstDistance * spacing && options.noise.unit == Length::Unit::kAuto;
  const bool follows = s.method == Method::kEnergy && options.preset != Preset::kPaper;
  const double scatter = !follows ? 0 : wide ? hidden_noise(s.epsilon.points / spacing) : noise / spacing;
  if (scatter > 0) follow_noise(scatter, options, cloud.size(), s);
  const bool light = starts_coarse(s, cloud.size()) || among_outliers;
  s.winding_weight = kWindingWeight * cube((light ? 1 : kLevelRatio) * spacing);
  choose_sums(options, cloud.size(), s);
  return s;
}

bool starts_coarse(const Settings& settings, std::size_t points) {
  return settings.coarse_to_fine && points / kTwiceAsFar >= kFewestCoarsePoints;
}

}  // namespace g3r
