#include "orient/votes.h"

#include "base/vector.h"

namespace g3r {
namespace {

using vector::dot;
using vector::normalised;

}  // namespace

double seen_from(const Vec3& place, const Vec3& point, const Vec3& normal) {
  return dot(normal, normalised(vector::subtract(place, point)));
}

NearestPlace::NearestPlace(const std::vector<Vec3>& places) : places_(places) {
  if (!places.empty()) neighbours_.emplace(places_);
}

const Vec3* NearestPlace::to(const Vec3& point) {
  if (!neighbours_) return nullptr;
  neighbours_->nearest(point, 1, index_, squared_);
  return &places_[index_[0]];
}

Voters::Voters(const std::vector<Vec3>& points, const Hints& hints)
    : points_(points), hints_(hints), sensors_(hints.sensors), inside_(hints.inside) {
  if (hints.up) up_ = normalised(*hints.up);
  // It turns with the cloud, lies in the plane of a flat one, and is where a scanner inside, about which points are dense, stands.
  if (hints.seen_from_inside && hints.sensors.empty()) middle_ = vector::mean(points);
}

double Voters::seen(std::size_t i, const Vec3& normal) {
  if (middle_) return seen_from(*middle_, points_[i], normal);
  if (!hints_.sensor_of_point.empty()) {
    const std::uint32_t sensor = hints_.sensor_of_point[i];
    return sensor == kNoSensor ? 0 : seen_from(hints_.sensors[sensor], points_[i], normal);
  }
  const Vec3* sensor = sensors_.to(points_[i]);
  return sensor == nullptr ? 0 : seen_from(*sensor, points_[i], normal);
}

double Voters::vote(std::size_t i, const Vec3& normal) {
  double sum = seen(i, normal);
  if (up_) sum += dot(normal, *up_);
  if (const Vec3* inside = inside_.to(points_[i])) sum -= seen_from(*inside, points_[i], normal);
  return sum;
}

}  // namespace g3r
