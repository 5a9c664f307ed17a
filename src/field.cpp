// The winding field of an oriented cloud, anywhere in space.
#include "areas.h"
#include "cloud/canonical_cloud.h"
#include "oriented_cloud.h"
#include "sum/fast_sum.h"

#include <g3r/g3r.h>

#include <cmath>
#include <utility>

namespace g3r {
namespace {

constexpr double kDefaultWidth = 0.55;  // spacings; the width of the refinement
constexpr double kAccuracy = 1e-3;      // of the sums

}  // namespace

OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals, const std::vector<double>& areas) {
  std::vector<Vec3> kept;  // all but outliers, which have no area and may be far away
  std::vector<std::size_t> input;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (areas[i] == 0) continue;
    kept.push_back(points[i]);
    input.push_back(i);
  }
  OrientedCloud out;
  out.cloud = canonical_cloud(PointsView(kept));
  out.eta.assign(out.cloud.size(), Vec3{0, 0, 0});
  const double scale = out.cloud.frame.scale;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const std::uint32_t p = out.cloud.point_of[k];
    if (p == kNoPoint) continue;
    const double area = areas[input[k]] * scale * scale;  // from the left: the square of a scale may leave the range of double
    for (std::size_t a = 0; a < 3; ++a) out.eta[p][a] += area * normals[input[k]][a];
  }
  out.spacing = out.cloud.set.spacing();
  return out;
}

OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals) {
  OrientedCloud out;
  out.cloud = canonical_cloud(points);
  std::vector<Vec3> merged(out.cloud.size(), Vec3{0, 0, 0});
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t p = out.cloud.point_of[i];
    if (p == kNoPoint) continue;
    for (std::size_t a = 0; a < 3; ++a) merged[p][a] += normals[i][a] / out.cloud.multiplicity[p];
  }
  out.eta = area_vectors(out.cloud.set, merged, {}, nullptr);
  out.spacing = out.cloud.set.spacing();
  return out;
}

struct Field::Impl {
  OrientedCloud oriented;
  FastSum sum;

  // Queries in normalised units.
  [[nodiscard]] std::vector<Vec3> unit(const PointsView& queries) const {
    std::vector<Vec3> out(queries.count);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = oriented.cloud.frame.to_unit(queries[i]);
    return out;
  }
};

Field::Field(const PointsView& points, const Orientation& orientation, double width) {
  if (orientation.normals.size() != points.count || orientation.areas.size() != points.count) {
    throw InvalidInput("field: " + std::to_string(points.count) + " points but " + std::to_string(orientation.normals.size()) + " normals");
  }
  if (!(width >= 0) || !std::isfinite(width)) throw InvalidInput("field: the width must be 0 (automatic) or positive");
  OrientedCloud oriented = oriented_cloud(points, orientation.normals, orientation.areas);
  const double unit_width = width > 0 ? oriented.cloud.frame.length_to_unit(width) : kDefaultWidth * oriented.spacing;
  FastSum sum(oriented.cloud.points(), oriented.cloud.morton(), Widths(unit_width), sum_plan(kAccuracy, oriented.cloud.size()));
  impl_ = std::unique_ptr<Impl>(new Impl{std::move(oriented), std::move(sum)});
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
