#include "orient/sensor_trust.h"

#include "base/vector.h"
#include "cloud/blocked_sights.h"
#include "cloud/constants.h"
#include "cloud/some_places.h"
#include "cpu/parallel.h"
#include "orient/votes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace g3r {
namespace {

// One point that some sensors should have seen.
struct Sight {
  std::uint32_t sensor = kNoSensor;  // its own, if that is known
  double squarest = 0;               // cosine, to the one that would see it squarest; 0: there is none
  bool hidden = false;               // from all of them
};

// Numbers of the sensors that may have seen a point.
std::vector<std::uint32_t> sensors_of(std::uint32_t i, const Vec3& point, const Hints& hints, const Neighbours& sensors) {
  std::vector<std::uint32_t> numbers;
  if (hints.sensor_of_point.empty()) {
    std::vector<double> squared;
    sensors.nearest(point, kMostSensors, numbers, squared);
  } else if (hints.sensor_of_point[i] != kNoSensor) {
    numbers.push_back(hints.sensor_of_point[i]);
  }
  return numbers;
}

Sight look_at(const PointSet& set, std::uint32_t i, const Hints& hints, const Neighbours& sensors) {
  const SeenPoint seen = seen_point(set, i);
  Sight sight;
  sight.hidden = true;
  if (!hints.sensor_of_point.empty()) sight.sensor = hints.sensor_of_point[i];
  for (const std::uint32_t s : sensors_of(i, seen.point, hints, sensors)) {
    const Vec3& place = hints.sensors[s];
    sight.squarest = std::max(sight.squarest, std::abs(seen_from(place, seen.point, seen.normal)));
    sight.hidden = sight.hidden && is_blocked(set, seen, place);
  }
  return sight;
}

// Sums of cosines.
struct Share {
  double hidden = 0;
  double all = 0;
  void add(const Sight& sight) {
    hidden += sight.hidden ? sight.squarest : 0;
    all += sight.squarest;
  }
  // With one point that has the share `of_all`.
  [[nodiscard]] double with(double of_all) const { return (hidden + of_all) / (all + 1); }
};

}  // namespace

SensorTrust find_sensor_trust(const PointSet& set, const std::vector<std::uint32_t>& points, const Hints& hints,
                              const std::atomic<bool>* cancel) {
  SensorTrust trust;
  trust.of_sensor.assign(hints.sensors.size(), 1);
  if (hints.sensors.empty() || points.empty() || set.size() < kFewestSurfacePoints) return trust;
  const Neighbours sensors(hints.sensors);
  (void)set.smoothed_spacing();  // made here, as the loop below only reads them
  (void)set.tree();
  const SomePlaces some = SomePlaces::at_least(kFewPlaces, points.size());
  std::vector<Sight> sights(some.size());
  parallel::for_each(
      some.size(), [&](std::size_t k) { sights[k] = look_at(set, points[some[k]], hints, sensors); }, cancel);
  Share all;
  std::vector<Share> own(hints.sensors.size());
  for (const Sight& sight : sights) {
    all.add(sight);
    if (sight.sensor != kNoSensor) own[sight.sensor].add(sight);
  }
  trust.hidden_share = all.all > 0 ? all.hidden / all.all : 0;
  for (std::size_t s = 0; s < own.size(); ++s) {
    const double hidden = hints.sensor_of_point.empty() ? trust.hidden_share : own[s].with(trust.hidden_share);
    trust.of_sensor[s] = std::max(0.0, 1 - 2 * hidden);
  }
  return trust;
}

}  // namespace g3r
