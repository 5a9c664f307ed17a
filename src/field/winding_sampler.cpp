#include "field/winding_sampler.h"

#include "base/median.h"

#include <utility>

namespace g3r {
namespace {

// The winding number at the points below which they face into a solid: it is 1/2 where they face out of one, 0 on open surfaces and -1/2
// where they face in, so this is half-way between the last two.
constexpr double kInsideOut = -0.25;
// The points whose median that is: one in a hundred wrong signs does not move it, and they take no time.
constexpr std::size_t kProbes = 500;

}  // namespace

WindingSampler::WindingSampler(const OrientedCloud& oriented, const std::atomic<bool>* cancel)
    : oriented_(oriented),
      cancel_(cancel),
      sum_(oriented.cloud.points(), Widths(kFieldWidth * oriented.spacing), sum_plan(kFieldAccuracy, oriented.cloud.size()), cancel) {}

void WindingSampler::sample(const std::vector<Vec3>& queries, std::vector<double>& value, std::vector<Vec3>* gradient) const {
  value = sum_.winding_at(oriented_.eta, queries, cancel_);
  if (gradient == nullptr) return;
  *gradient = sum_.winding_gradient_at(oriented_.eta, queries, cancel_);
  for (Vec3& g : *gradient) {
    for (double& c : g) c = -c;
  }
}

bool is_inside_out(const OrientedCloud& oriented, const WindingSampler& field) {
  const std::vector<Vec3>& points = oriented.cloud.points();
  std::vector<Vec3> probes;
  for (std::size_t i = 0; i < points.size(); i += (points.size() + kProbes - 1) / kProbes) probes.push_back(points[i]);
  std::vector<double> winding;
  field.sample(probes, winding, nullptr);
  return median(std::move(winding)) < kInsideOut;
}

}  // namespace g3r
