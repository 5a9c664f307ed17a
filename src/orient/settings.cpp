#include "orient/settings.h"

#include "base/whole_bytes.h"
#include "cloud/chance.h"
#include "cloud/sites.h"
#include "expansions/expansions.h"
#include "orient/projection.h"
#include "orient/site_parts.h"

#include <g3r/error.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>

namespace g3r {
namespace {

// The default: energy form. Widths in spacings h.
constexpr double kCoarsestEpsilon = 0.5;  // without a start: converges faster, finds more sides
// Weights l of the winding number, in h^3: S eta and l W^T W eta keep their proportion for any number of points.
constexpr double kWindingWeight = 250;  // from eta = 0; larger converges slower, 0 loses nested shells
// With a coarse start or among outliers, and of further steps: finds more sides of thin walls; less costs narrow gaps.
constexpr double kContinuedWindingWeight = 30;
constexpr double kPolishWindingWeight = 70;  // of clean points and little noise; more costs sides, less costs narrow gaps and smooth shapes
constexpr double kTolerance =
    2.5e-3;  // of further steps and of least squares too; slats and spokes need this residual; smooth shapes get there in half the steps
constexpr const char* kEnergySchedule = "45 cg";
constexpr const char* kGreenSchedule = "20 cg";  // least squares over the harmonics; more cost time, and change sides for better and worse
constexpr double kAcceptedResidual = 0.1;        // random points on spheres end at 0.05 after a coarse start, with normals right to 1e-4
// Steps in which what is known reaches the far sides: fewer leave those undecided. More fit what is wrong with the equations: noise, above
// all in the polish, and after a coarse start, where smooth shapes take 2 to 10, open surfaces and the outliers that are always left.
constexpr int kFewSteps = 10;
// The default on noisy input, sigma in spacings h: the field must not see single points. Kernels of a given number of sigma hide the
// scatter of points, and blur walls as thin as that; below a spacing fewer points share the scatter, and walls matter more. So the width
// grows with the square of sigma first and in proportion later, w = A s^2 / hypot(s, 1) for s = sigma / h.
constexpr double kNoisyWidth = 2 * kSigmas;  // A, the noise's whole breadth in the end: more blurs walls, less turns shells in cavities
// Raw solutions fit the noise with every step, and the more noise there is the sooner: h / sigma times this many steps.
constexpr double kStepsPerNoise = 7;
// Noise turns the normal of a patch of side s by about sigma h / s^2: widths in proportion to sqrt(sigma h) leave one accuracy. Those in
// proportion to sigma hide the scatter, without which shells in cavities turn. Between the two, with this power of sigma / h:
constexpr double kNoisyPolishPower = 0.6;
constexpr double kNoisyPolishEpsilon = 1.95;  // h; 1.8 and the power 1/2 leave more sides of thin walls right, and turn shells
constexpr double kNoisyPolishWidth = 2.4;     // h
// The single layer at the middle of a flat disk of area h^2: kernels this wide leave out most of the term of a point and itself, and
// without it the polish turns shells in cavities.
const double kFlatPatch = std::numbers::inv_sqrtpi / 2;  // 1/h
// Of the sums. Solves from 0 amplify errors with every step; with a start kContinuedAccuracy does.
constexpr double kAccuracy = 1e-2;
// The polish is one more level on the same points.
constexpr int kPolishSteps = 5;  // narrow gaps want more, smooth shapes fewer
// The paper preset.
constexpr double kPaperLeafFactor = 0.8;
constexpr double kPaperLeastEpsilon = 0.15;  // h; below, 80 iterations are far from converged (random samples have very close pairs)
constexpr const char* kPaperSchedule = "20 sd 60 cg";
constexpr std::size_t kPaperDensePoints = 500;  // "small N": seconds, not minutes
constexpr int kDefaultDegree = 2;

// Not automatic, in the cloud's frame.
double in_frame(const Length& length, const CanonicalCloud& cloud, double spacing) {
  switch (length.unit) {
    case Length::Unit::kInput:
      return cloud.frame.length_to_unit(length.value);
    case Length::Unit::kPercent: {
      Vec3 low = cloud.points().front();
      Vec3 high = low;
      for (const Vec3& p : cloud.points()) {
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], p[a]);
          high[a] = std::max(high[a], p[a]);
        }
      }
      return length.value / 100 * std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    }
    case Length::Unit::kSpacing:
      return length.value * spacing;
    default:
      return length.value;
  }
}

// Width in spacings of the kernels that hide this noise, in spacings too.
double noisy_width(double noise) { return kNoisyWidth * noise * noise / std::hypot(noise, 1); }

// The noise that kernels of this width hide.
double hidden_noise(double width) {
  const double sigmas = width / kNoisyWidth;
  return std::sqrt(sigmas * (sigmas + std::hypot(sigmas, 2)) / 2);
}

// What the program has of every point that it is given: input, result, and which of the distinct points it is.
struct Given {
  Vec3 point, normal;
  double area;
  float confidence;
  std::uint32_t index, multiplicity;
};

double cube(double x) { return x * x * x; }

void require(bool good, const std::string& message) {
  if (!good) throw InvalidInput(message);
}

// Widths and weights of the polish for noise of this many spacings.
void polish_under_noise(double noise, Settings& s) {
  const double patch = std::pow(noise, kNoisyPolishPower) * s.spacing;
  s.polish_epsilon = {s.polish_epsilon.points, kNoisyPolishEpsilon * patch, 1 - kNoisyPolishPower};
  s.polish_width = {s.polish_width.points, kNoisyPolishWidth * patch, 1 - kNoisyPolishPower};
  s.polish_damping = kFlatPatch / s.spacing;
  // W eta = 1/2 is wrong at points off the surface, and the more so the farther off they are: the length whose cube its weight is falls
  // from h to that over hypot(1, sigma / h). The solve stops so early that less weight would change nothing.
  s.polish_winding_weight = kPolishWindingWeight * cube(s.spacing / std::hypot(noise, 1));
}

// Widths, steps and the polish of the default for noise of this many spacings.
void follow_noise(double noise, const Options& options, std::size_t points, Settings& s) {
  const double width = noisy_width(noise) * s.spacing;
  s.noise = noise * s.spacing;
  s.refinement_width.noise = width;
  if (options.epsilon.unit == Length::Unit::kAuto) {
    s.epsilon.noise = width;
    s.coarsest_epsilon.noise = width;
  }
  polish_under_noise(noise, s);
  if (s.polish_steps > 0) s.polish_steps = kFewSteps;
  s.unsure_of_noise = noise;  // a noise of one h makes nearly all unsure
  if (s.epsilon.typical() > kFirstDistance * s.spacing) s.cluster_side = s.epsilon.typical();
  // A start from fewer points has lost the walls where noise asks for wider kernels: half of the sides of 95,000 points on walls of 3 h.
  if (noise > noise_of_clean_widths()) s.coarse_to_fine = false;
  if (options.schedule.empty() && !starts_coarse(s, points)) {
    const double steps = std::clamp(kStepsPerNoise / noise, static_cast<double>(kFewSteps), static_cast<double>(s.schedule.front().count));
    s.schedule_text = std::to_string(static_cast<int>(steps)) + " cg";
    s.schedule = parse_schedule(s.schedule_text);
    if (options.tolerance < 0) s.tolerance = 0;
  }
}

}  // namespace

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

double noise_of_clean_widths() { return hidden_noise(kRefinementWidth); }

Settings choose_settings(const Options& options, const CanonicalCloud& cloud, double spacing, double noise, std::size_t outliers) {
  const bool paper = options.preset == Preset::kPaper;
  Settings s;
  s.without = parse_steps(options.without);
  s.method = options.method != Method::kAuto ? options.method : paper ? Method::kGreen : Method::kEnergy;
  const bool harmonics_given = options.degree >= 0 || !options.harmonics.empty();
  if (harmonics_given && options.method == Method::kAuto) s.method = Method::kGreen;
  require(!harmonics_given || s.method == Method::kGreen, "degree and harmonics belong to the method green; leave them out with energy");
  require(options.degree < 0 || options.harmonics.empty(), "give either a degree or a list of harmonics, not both");
  require(options.degree <= kMaxHarmonicDegree, "degree must be between 0 and " + std::to_string(kMaxHarmonicDegree));
  require(options.threads >= 0, "threads must be 0 (all cores) or positive");
  require(options.tolerance == -1 || (options.tolerance >= 0 && options.tolerance < 1), "tolerance must be in [0, 1)");
  if (s.method == Method::kGreen) {
    s.harmonics = options.harmonics.empty() ? harmonics_of_degrees(0, options.degree >= 0 ? options.degree : kDefaultDegree)
                                            : parse_harmonics(options.harmonics);
  }
  const bool green = s.method == Method::kGreen;
  s.epsilon.points = kEpsilon * spacing;
  if (paper) s.epsilon.points = std::max(paper_epsilon(cloud), kPaperLeastEpsilon * spacing);
  if (options.epsilon.unit != Length::Unit::kAuto) {
    require(options.epsilon.value > 0 && std::isfinite(options.epsilon.value), "epsilon must be a positive number");
    s.epsilon.points = in_frame(options.epsilon, cloud, spacing);
  }
  require(options.noise.unit == Length::Unit::kAuto || (s.method == Method::kEnergy && !paper),
          "noise belongs to the method energy of the default preset");
  s.spacing = spacing;
  s.coarsest_epsilon = s.epsilon;
  if (!green && options.epsilon.unit == Length::Unit::kAuto) s.coarsest_epsilon.points = kCoarsestEpsilon * spacing;
  s.refinement_width.points = paper ? 0 : kRefinementWidth * spacing;
  s.polish_steps = paper || contains(s.without, Step::kPolish) ? 0 : kPolishSteps;
  s.polish_epsilon.points = std::min(s.epsilon.points, kEpsilon / kLevelRatio * spacing);
  s.polish_width.points = kRefinementWidth / kLevelRatio * spacing;
  s.polish_winding_weight = kPolishWindingWeight * cube(spacing);

  require(options.solver != Solver::kDense || green, "the dense solver belongs to the method green");
  s.dense = options.solver == Solver::kDense ||
            (options.solver == Solver::kAuto && paper && green && options.schedule.empty() && cloud.size() <= kPaperDensePoints);
  require(!options.condition_number || s.dense, "the condition number is that of the dense system: set the solver to dense");
  s.schedule_text = !options.schedule.empty() ? options.schedule : paper ? kPaperSchedule : green ? kGreenSchedule : kEnergySchedule;
  s.schedule = parse_schedule(s.schedule_text);
  s.coarse_to_fine = !paper && !green && options.schedule.empty() && !contains(s.without, Step::kCoarseStart);
  // Clean clouds lose one point, very uneven ones 0.6 %.
  const bool among_outliers = static_cast<double>(outliers) > kFalseAlarms * static_cast<double>(cloud.size());
  s.continued_schedule = {{kFewSteps, StepKind::kConjugateGradient}};
  if (!among_outliers && !contains(s.without, Step::kMoreSteps)) s.doubtful_schedule = {kMoreSteps};
  s.tolerance = options.tolerance >= 0 ? options.tolerance : paper ? 0 : kTolerance;
  s.accepted_residual = options.tolerance >= 0 ? options.tolerance : kAcceptedResidual;
  // Starts, and what starts from them, are no better than their sums.
  s.continued_tolerance = options.tolerance >= 0 ? options.tolerance : kContinuedAccuracy;
  s.doubtful_tolerance = options.tolerance >= 0 ? options.tolerance : kTolerance;
  s.start_tolerance = std::max(s.tolerance, kAccuracy);
  // An epsilon as wide as a scale of fewer points, asked for, is taken to mean noise.
  const bool wide = s.epsilon.points > kFirstDistance * spacing && options.noise.unit == Length::Unit::kAuto;
  const double scatter = paper || green ? 0 : wide ? hidden_noise(s.epsilon.points / spacing) : noise / spacing;
  if (scatter > 0) follow_noise(scatter, options, cloud.size(), s);
  const bool light = starts_coarse(s, cloud.size()) || among_outliers;
  s.winding_weight = (light ? kContinuedWindingWeight : kWindingWeight) * cube(spacing);
  s.accuracy = options.accuracy != -1 ? options.accuracy : kAccuracy;
  s.first_sums = sum_plan(s.accuracy, cloud.size());
  const bool continued = options.accuracy == -1 && s.method == Method::kEnergy;
  s.sums = sum_plan(continued ? kContinuedAccuracy : s.accuracy, cloud.size());
  return s;
}

Settings after_projection(const Settings& settings) {
  Settings s = settings;
  polish_under_noise(projected_noise(s.noise, s.spacing) / s.spacing, s);
  s.polish_tolerance = s.continued_tolerance;
  return s;
}

bool starts_coarse(const Settings& settings, std::size_t points) {
  return settings.coarse_to_fine && points / kTwiceAsFar >= kFewestCoarsePoints;
}

std::size_t planned_memory(const Settings& settings, std::size_t given, std::size_t used) {
  constexpr double kProgram = 12e6;    // code, libraries, thread stacks, queries of the certificate
  constexpr double kMatrices = 180;    // of the expansions, that the far pairs of a cloud share: measured
  constexpr double kPerUnknown = 330;  // while the equations are solved,
  constexpr double kBase = 255;        // or what stays of it while sides are certified,
  constexpr double kPerSite = 400;     // and what each of the sites then takes;
  constexpr double kMoved = 100;       // under noise, besides, points that are moved onto their surface
  constexpr double kFilled = 0.7;      // as many as a maximal sample of points so far apart has, in squares of that side
  const std::size_t harmonics = settings.method == Method::kGreen ? settings.harmonics.size() : 0;
  const auto unknowns = static_cast<double>(used);
  const double solve = (kPerUnknown + 2 * sizeof(Vec3) * static_cast<double>(harmonics)) * unknowns;
  const double apart = site_distance(used, settings.spacing, settings.noise) / settings.spacing;
  const double sites = apart > 0 ? kFilled * unknowns / (apart * apart) : unknowns;
  const double certificate = (kBase + (settings.noise > 0 ? kMoved : 0)) * unknowns + kPerSite * sites;
  const SumPlan& sums = settings.first_sums;
  const auto terms = static_cast<double>(coefficient_count(sums.order));
  const double matrix = terms * terms * (sums.double_precision ? sizeof(double) : sizeof(float));
  const double expansions = sums.direct ? 0 : kMatrices * matrix;
  double bytes = kProgram + expansions + static_cast<double>(given * sizeof(Given)) + std::max(solve, certificate);
  if (settings.dense) bytes += 3 * unknowns * 3 * unknowns * sizeof(double);
  return whole_bytes(bytes);
}

void require_memory(std::size_t planned_bytes, const Options& options) {
  if (options.max_memory == 0 || planned_bytes <= options.max_memory) return;
  throw Unavailable("the plan needs " + std::to_string(mebibytes(planned_bytes)) + " MiB, the limit is " +
                    std::to_string(mebibytes(options.max_memory)) +
                    " MiB; raise the limit, thin the cloud, or lower the depth of the mesh");
}

}  // namespace g3r
