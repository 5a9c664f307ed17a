// The winding field of an oriented cloud, anywhere in space.
#include "cloud/canonical_cloud.h"
#include "field/oriented_cloud.h"
#include "sum/device_scope.h"
#include "sum/fast_sum.h"

#include <g3r/g3r.h>

#include <cmath>
#include <utility>

namespace g3r {
namespace {

// The width of the field in spacings, unless one is given: that of the refinement, so that -grad w at a point is its refined normal.
constexpr double kDefaultWidth = 0.55;
// The accuracy of its sums: what callers get is the value itself, not only the side of a level.
constexpr double kAccuracy = 1e-3;

}  // namespace

struct Field::Impl {
  gpu::Lease device;
  OrientedCloud oriented;
  FastSum sum;

  // Queries in normalised units.
  [[nodiscard]] std::vector<Vec3> unit(const PointsView& queries) const {
    std::vector<Vec3> out(queries.count);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = oriented.cloud.frame.to_unit(queries[i]);
    return out;
  }
};

Field::Field(const PointsView& points, const Orientation& orientation, double width, const std::string& device) {
  if (orientation.normals.size() != points.count || orientation.areas.size() != points.count) {
    throw InvalidInput("field: " + std::to_string(points.count) + " points but " + std::to_string(orientation.normals.size()) +
                       " normals and " + std::to_string(orientation.areas.size()) + " areas");
  }
  if (!(width >= 0) || !std::isfinite(width)) throw InvalidInput("field: the width must be 0 (automatic) or positive");
  gpu::Lease lease(device, points.count);
  OrientedCloud oriented = oriented_cloud(points, orientation.normals, orientation.areas);
  const double unit_width = width > 0 ? oriented.cloud.frame.length_to_unit(width) : kDefaultWidth * oriented.spacing;
  SumPlan plan = sum_plan(kAccuracy, oriented.cloud.size());
  plan.execution = lease.execution();
  FastSum sum(oriented.cloud.points(), Widths(unit_width), plan);
  impl_ = std::unique_ptr<Impl>(new Impl{std::move(lease), std::move(oriented), std::move(sum)});
}

Field::~Field() = default;
Field::Field(Field&&) noexcept = default;
Field& Field::operator=(Field&&) noexcept = default;

std::vector<double> Field::value(const PointsView& queries, const Monitor& monitor) const {
  return impl_->sum.winding_at(impl_->oriented.eta, impl_->unit(queries), monitor.cancel);
}

std::vector<Vec3> Field::gradient(const PointsView& queries, const Monitor& monitor) const {
  std::vector<Vec3> out = impl_->sum.winding_gradient_at(impl_->oriented.eta, impl_->unit(queries), monitor.cancel);
  for (Vec3& g : out) {
    for (double& c : g) c *= -impl_->oriented.cloud.frame.scale;
  }
  return out;
}

}  // namespace g3r
