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

NearestPlaces::NearestPlaces(const std::vector<Vec3>& places) : places_(places) {
  if (!places.empty()) neighbours_.emplace(places_);
}

void NearestPlaces::find(const Vec3& point, std::size_t most) {
  if (neighbours_) neighbours_->nearest(point, most, index_, squared_);
}

Voters::Voters(const std::vector<Vec3>& points, const Hints& hints, const std::vector<double>& trusted)
    : points_(points), hints_(hints), trusted_(trusted), sensors_(hints.sensors), inside_(hints.inside) {
  if (hints.up) up_ = normalised(*hints.up);
  // It turns with the cloud, lies in the plane of a flat one, and is where a scanner inside, about which points are dense, stands.
  if (hints.seen_from_inside && hints.sensors.empty()) middle_ = vector::mean(points);
}

double Voters::trusted(std::size_t i) const {
  if (trusted_.empty()) return 1;
  if (hints_.sensor_of_point.empty()) return trusted_.front();
  const std::uint32_t sensor = hints_.sensor_of_point[i];
  return sensor == kNoSensor ? 1 : trusted_[sensor];
}

double Voters::seen(std::size_t i, const Vec3& normal) {
  if (middle_) return seen_from(*middle_, points_[i], normal);
  if (!hints_.sensor_of_point.empty()) {
    const std::uint32_t sensor = hints_.sensor_of_point[i];
    return sensor == kNoSensor ? 0 : trusted(i) * seen_from(hints_.sensors[sensor], points_[i], normal);
  }
  sensors_.find(points_[i], kMostSensors);
  if (sensors_.count() == 0 || sensors_.squared_distance(0) == 0) return 0;
  double sum = 0;
  double weights = 0;
  for (std::size_t k = 0; k < sensors_.count(); ++k) {
    const double weight = sensors_.squared_distance(0) / sensors_.squared_distance(k);
    sum += weight * seen_from(sensors_.place(k), points_[i], normal);
    weights += weight;
  }
  return trusted(i) * sum / weights;
}

double Voters::vote(std::size_t i, const Vec3& normal) {
  double sum = seen(i, normal);
  if (up_) sum += dot(normal, *up_);
  inside_.find(points_[i], 1);
  if (inside_.count() > 0) sum -= seen_from(inside_.place(0), points_[i], normal);
  return sum;
}

}  // namespace g3r
