#include "mesh/field_local_fit.h"

#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace g3r::mesh {
namespace {

using Eigen::Vector3d;

// Weights are about exp(-t) for t up to this and 0 beyond; it is a power of two, for bell().
constexpr double kFaint = 16;
// A factor larger than what rounding can make of a squared distance: without it the search might miss a point as near.
constexpr double kRoundedUp = 1 + kRounding;
// About exp(-t), 0 at kFaint.
double bell(double t) {
  const double a = 1 - t / kFaint, a2 = a * a, a4 = a2 * a2, a8 = a4 * a4;
  return a8 * a8;
}

}  // namespace

LocalFit::LocalFit(const OrientedPoints& points, const Neighbours& neighbours, const std::vector<std::uint32_t>& near)
    : points_(points),
      near_(near),
      count_(near_.size() / points.positions.size()),
      neighbours_(neighbours),
      widest_(*std::max_element(points.spacing.begin(), points.spacing.end())) {}

// The point nearest to x and its squared distance; kNone if it is surely farther than `reach` of its spacings. Places are mostly asked for
// one after the other, so the search goes from the last point found to the nearest of its neighbours, until no point that is not its
// neighbour can be nearer. Where it starts does not change what is found.
std::uint32_t LocalFit::nearest(const Vector3d& x, double reach, double& squared) const {
  thread_local std::uint32_t last = 0;
  const std::vector<Vec3>& p = points_.positions;
  if (last >= p.size()) last = 0;
  const Vec3 place{x[0], x[1], x[2]};
  const auto squared_distance = [](const Vec3& a, const Vec3& b) {  // as the tree of neighbours_ computes it
    const double dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
    return dx * dx + dy * dy + dz * dz;
  };
  const double most = reach * widest_;
  squared = kRoundedUp * most * most;
  while (true) {
    const std::uint32_t centre = last;
    const std::uint32_t* const near = near_.data() + centre * count_;
    const double to_centre = squared_distance(place, p[centre]);
    double best = to_centre;
    bool tie = false;
    for (std::size_t k = 0; k < count_; ++k) {
      const double d = squared_distance(place, p[near[k]]);
      if (d > best || near[k] == last) continue;
      tie = d == best;
      best = d;
      last = near[k];
    }
    const double others = std::sqrt(squared_distance(p[centre], p[near[count_ - 1]])) - std::sqrt(to_centre);
    if (!tie && others > 0 && kRoundedUp * best < others * others) {
      squared = best;
      return last;
    }
    squared = std::min(squared, kRoundedUp * best);
    if (last == centre || tie) break;
  }
  const std::uint32_t found = neighbours_.nearest(place, squared, kNone);
  if (found != kNone) last = found;
  return found;
}

// Is x farther from the tangent planes of all points next to point i than surface curves away from them, all on one side, and do these
// belong to one patch? Then their mean plane is fit enough to say which side: half of the time.
bool LocalFit::is_clear_of(std::uint32_t i, const Vector3d& x, double scale, QuadraticPatch& plane) const {
  const Vector3d axis = to_eigen(points_.normals[i]), p0 = to_eigen(points_.positions[i]);
  const bool outside = axis.dot(x - p0) > 0;
  const double first = (x - p0).squaredNorm(), clear = kDiscHalf * points_.spacing[i];
  Vector3d mean_p = Vector3d::Zero(), mean_n = Vector3d::Zero();
  double total = 0;
  for (std::size_t k = 0; k < std::min(kFitPoints, count_); ++k) {
    const std::uint32_t j = near_[i * count_ + k];
    const Vector3d p = to_eigen(points_.positions[j]), n = to_eigen(points_.normals[j]);
    const double d = n.dot(x - p);
    if ((d > 0) != outside || std::abs(d) < clear || n.dot(axis) <= kSameLocalPatch) return false;
    const double weight = bell(std::min(((x - p).squaredNorm() - first) * scale, kFaint));
    mean_p += weight * p;
    mean_n += weight * n;
    total += weight;
  }
  plane.origin = mean_p / total;
  plane.frame = tangent_frame(mean_n.normalized());
  return true;
}

LocalSurface LocalFit::fit(const Vector3d& x, double reach, const Vector3d* direction, Detail detail) const {
  thread_local std::vector<FitPoint> members;
  double squared = 0;
  const std::uint32_t nearest = this->nearest(x, reach, squared);
  LocalSurface out;
  if (nearest == kNone) return out;
  out.spacing = points_.spacing[nearest];
  const double h = out.spacing;
  if (std::sqrt(squared) > reach * h) return out;
  const double scale = 1 / (2 * kWidth * kWidth * h * h);
  if (detail == Detail::kSide && is_clear_of(nearest, x, scale, out.patch[0])) {
    out.count = 1;
    out.simple = true;
    return out;
  }
  gather(x, nearest, scale, direction, members);
  return surface_through(members, h, x);
}

// The points that take part in the fit at x, nearest first, with their weights.
void LocalFit::gather(const Vector3d& x, std::uint32_t nearest, double scale, const Vector3d* direction,
                      std::vector<FitPoint>& members) const {
  // The nearest ones, by insertion: the neighbours are nearly in order.
  std::array<std::pair<double, std::uint32_t>, kFitPoints> near;  // squared distances and points
  std::size_t used = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    const std::uint32_t i = near_[nearest * count_ + k];
    const std::pair now{(to_eigen(points_.positions[i]) - x).squaredNorm(), i};
    if (used == kFitPoints && now >= near[used - 1]) continue;
    std::size_t place = used < kFitPoints ? used++ : used - 1;
    for (; place > 0 && now < near[place - 1]; --place) near[place] = near[place - 1];
    near[place] = now;
  }
  members.clear();
  double first = -1;
  for (std::size_t k = 0; k < used; ++k) {
    const auto [r2, i] = near[k];
    const Vector3d n = to_eigen(points_.normals[i]);
    if (direction != nullptr && n.dot(*direction) < -kSlant) continue;  // on the other wall
    if (first < 0) first = r2;
    const double exponent = (r2 - first) * scale;
    if (exponent >= kFaint) break;
    members.push_back({to_eigen(points_.positions[i]), n, bell(exponent)});
  }
}

std::vector<double> wall_thickness(const OrientedPoints& points, const std::vector<std::uint32_t>& near) {
  const std::size_t n = points.positions.size(), stride = near.size() / n, k = std::min(stride, kFitPoints);
  std::vector<double> out(n, std::numeric_limits<double>::infinity());
  parallel::for_blocks(n, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d p = to_eigen(points.positions[i]), normal = to_eigen(points.normals[i]);
      for (std::size_t j = 0; j < k; ++j) {
        const std::uint32_t other = near[i * stride + j];
        if (normal.dot(to_eigen(points.normals[other])) > -kAlong) continue;  // sharp edges turn less
        out[i] = std::min(out[i], std::abs(normal.dot(to_eigen(points.positions[other]) - p)));
      }
    }
  });
  return out;
}

}  // namespace g3r::mesh
