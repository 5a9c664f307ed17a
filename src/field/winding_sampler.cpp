#include "field/winding_sampler.h"

#include "base/median.h"

#include <utility>

namespace g3r {
namespace {

constexpr double kFieldWidth = 0.35;     // of the winding field in spacings
constexpr double kFieldAccuracy = 1e-2;  // of its sums; only its side of a level counts, with a margin of 0.2
constexpr double kInsideOut = -0.25;     // winding number at the points; 1/2 if they face out of a solid, -1/2 into it, 0 on open surfaces;
constexpr std::size_t kProbes = 500;     // points asked for it

}  // namespace

WindingSampler::WindingSampler(const OrientedCloud& oriented, const std::atomic<bool>* cancel)
    : oriented_(oriented),
      cancel_(cancel),
      sum_(oriented.cloud.points(), oriented.cloud.morton(), Widths(kFieldWidth * oriented.spacing),
           sum_plan(kFieldAccuracy, oriented.cloud.size()), cancel) {}

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
