// The winding field of an oriented cloud, anywhere in space.
#include "cloud/canonical_cloud.h"
#include "cloud/outliers.h"
#include "cloud/spacing.h"
#include "oriented_cloud.h"
#include "sum/fast_sum.h"

#include <g3r/g3r.h>

#include <cmath>
#include <utility>

namespace g3r {
namespace {

constexpr double kDefaultWidth = 0.55;  // spacings; the width of the refinement
constexpr double kAccuracy = 1e-3;      // of the sums

constexpr std::size_t kFewestPoints = 4;  // of a surface

// `local`: the local spacings, empty if they are not known.
OrientedCloud with_areas(CanonicalCloud cloud, const std::vector<Vec3>& normals, const std::vector<double>& areas,
                         std::vector<double> local) {
  OrientedCloud out;
  out.cloud = std::move(cloud);
  out.eta.assign(out.cloud.size(), Vec3{0, 0, 0});
  const double scale = out.cloud.frame.scale * out.cloud.frame.scale;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t p = out.cloud.point_of[i];
    if (p == kNoPoint) continue;
    for (std::size_t a = 0; a < 3; ++a) out.eta[p][a] += scale * areas[i] * normals[i][a];
  }
  std::vector<std::uint32_t> without_area;  // outliers
  for (std::uint32_t p = 0; p < out.eta.size(); ++p) {
    if (out.eta[p] == Vec3{0, 0, 0}) without_area.push_back(p);
  }
  if (!without_area.empty() && out.eta.size() - without_area.size() >= kFewestPoints) {
    remove_points(out.cloud, without_area);
    std::erase(out.eta, Vec3{0, 0, 0});
    local.clear();
  }
  out.spacing = typical_spacing(local.empty() ? local_spacing(out.cloud.points) : std::move(local));
  return out;
}

}  // namespace

OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals, const std::vector<double>& areas) {
  return with_areas(canonical_cloud(points), normals, areas, {});
}

OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals) {
  CanonicalCloud cloud = canonical_cloud(points);
  std::vector<double> local = local_spacing(cloud.points);
  std::vector<double> areas(normals.size(), 0);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const std::uint32_t p = cloud.point_of[i];
    if (p == kNoPoint) continue;
    const double h = cloud.frame.length_to_world(local[p]);
    areas[i] = h * h / cloud.multiplicity[p];
  }
  return with_areas(std::move(cloud), normals, areas, std::move(local));
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
  FastSum sum(oriented.cloud.points, oriented.cloud.morton, Widths(unit_width), sum_plan(kAccuracy, oriented.cloud.size()));
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
