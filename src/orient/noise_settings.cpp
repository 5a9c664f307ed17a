#include "orient/noise_settings.h"

#include "cloud/constants.h"
#include "cloud/sites.h"
#include "orient/projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace g3r {
namespace {

// Steps of the first solve times sigma / h: every step fits the noise more, and the more noise there is the sooner.
constexpr double kStepsPerNoise = 7;
// The power of sigma / h that the widths of the polish are in proportion to. Noise turns the normal of a patch of side s by about
// sigma h / s^2, so that the power 1/2 leaves one accuracy; the power 1 hides the scatter, without which shells in cavities turn.
constexpr double kNoisyPolishPower = 0.6;
// Width in spacings of the kernels of the polish at sigma = h: 1.8 and the power 1/2 leave more sides of thin walls right, and turn shells.
constexpr double kNoisyPolishEpsilon = 1.95;
// Width in spacings of the refinement after the polish at sigma = h.
constexpr double kNoisyPolishWidth = 2.4;
// The single layer, times h, at the middle of a flat disk of area h^2: kernels this wide leave out most of the term of a point and itself,
// and without it the polish turns shells in cavities.
const double kFlatPatch = std::numbers::inv_sqrtpi / 2;

// Width in spacings of the kernels that hide this noise, in spacings too: the field must not see single points. Kernels of a given number
// of sigma hide the scatter of points, and blur walls as thin as that; below a spacing fewer points share the scatter, and walls matter
// more. So the width grows with the square of sigma first and in proportion later, w = A s^2 / hypot(s, 1) for s = sigma / h, with A the
// noise's whole breadth in the end, kNoiseBreadth: more blurs walls, less turns shells in cavities.
double noisy_width(double noise) { return kNoiseBreadth * noise * noise / std::hypot(noise, 1); }

// Widths and weights of the polish for noise of this many spacings.
void polish_under_noise(double noise, Settings& s) {
  const double patch = std::pow(noise, kNoisyPolishPower) * s.spacing;
  s.polish.epsilon = {s.polish.epsilon.points, kNoisyPolishEpsilon * patch, 1 - kNoisyPolishPower};
  s.polish.width = {s.polish.width.points, kNoisyPolishWidth * patch, 1 - kNoisyPolishPower};
  s.polish.damping = kFlatPatch / s.spacing;
  // W eta = 1/2 is wrong at points off the surface, and the more so the farther off they are: the length whose cube its weight is falls
  // from h to that over hypot(1, sigma / h). The solve stops so early that less weight would change nothing.
  const double length = s.spacing / std::hypot(noise, 1);
  s.polish.winding_weight = kPolishWindingWeight * length * length * length;
}

}  // namespace

double hidden_noise(double width) {
  const double sigmas = width / kNoiseBreadth;
  return std::sqrt(sigmas * (sigmas + std::hypot(sigmas, 2)) / 2);
}

double noise_of_clean_widths() { return hidden_noise(kRefinementWidth); }

void follow_noise(double noise, const Options& options, std::size_t points, Settings& s) {
  const double width = noisy_width(noise) * s.spacing;
  s.noise = noise * s.spacing;
  s.refinement_width.noise = width;
  if (options.epsilon.unit == Length::Unit::kAuto) {
    s.epsilon.noise = width;
    s.coarsest_epsilon.noise = width;
  }
  polish_under_noise(noise, s);
  if (s.polish.steps > 0) s.polish.steps = kFewSteps;
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

Settings after_projection(const Settings& settings) {
  Settings s = settings;
  polish_under_noise(projected_noise(s.noise, s.spacing) / s.spacing, s);
  s.polish.tolerance = s.continued_tolerance;
  return s;
}

}  // namespace g3r
