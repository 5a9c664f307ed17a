#include "orient/hints.h"

#include "base/vector.h"
#include "orient/closed_sides.h"
#include "orient/patch_sides.h"
#include "orient/votes.h"

#include <g3r/error.h>

#include <string>
#include <utility>

namespace g3r {
namespace {

bool has_any(const Hints& hints) {
  return hints.up || !hints.sensors.empty() || !hints.inside.empty() || hints.seen_from_inside || hints.flip;
}

void require_finite(const std::vector<Vec3>& places, const std::string& name) {
  for (const Vec3& place : places) {
    if (!vector::is_finite(place)) throw InvalidInput("the hint " + name + " must be finite");
  }
}

}  // namespace

HintEffect follow_hints(const HintedCloud& cloud, const std::atomic<bool>* cancel) {
  const std::size_t count = cloud.points.size();
  if (!has_any(cloud.hints) || count == 0) return {};
  HintEffect effect;
  bool has_closed = false;
  for (std::size_t i = 0; i < count && !has_closed; ++i) has_closed = cloud.patches.is_closed(i);
  Hints voting = cloud.hints;
  voting.inside.clear();
  for (const std::size_t k : inside_no_closed_part(cloud, cancel)) {
    if (has_closed && voting.inside.empty()) effect.inside_that_is_outside = k;
    voting.inside.push_back(cloud.hints.inside[k]);
  }
  Voters voters(cloud.points, voting, cloud.trusted);
  effect.decided.assign(count, 0);
  effect.turned.assign(count, 0);
  decide_patches(cloud, voters, effect);
  judge_closed_parts(cloud, voters, effect, cancel);
  for (std::size_t i = 0; i < count; ++i) {
    if ((effect.turned[i] != 0) == cloud.hints.flip) continue;
    cloud.sided.normals[i] = vector::scale(cloud.sided.normals[i], -1);
    cloud.sided.eta[i] = vector::scale(cloud.sided.eta[i], -1);
  }
  return effect;
}

std::vector<std::string> names_of(const Hints& hints) {
  std::vector<std::string> names;
  if (hints.up) names.emplace_back("up");
  if (!hints.sensors.empty()) names.emplace_back("sensor");
  if (!hints.inside.empty()) names.emplace_back("inside");
  if (hints.seen_from_inside) names.emplace_back("seen_from_inside");
  if (hints.flip) names.emplace_back("flip");
  return names;
}

void require_sound(const Hints& hints, std::size_t count) {
  require_finite(hints.sensors, "sensor");
  require_finite(hints.inside, "inside");
  if (hints.up) {
    require_finite({*hints.up}, "up");
    if (vector::normalised(*hints.up) == Vec3{0, 0, 0}) throw InvalidInput("the hint up must have a length above 0");
  }
  if (hints.sensor_of_point.empty()) return;
  if (hints.sensor_of_point.size() != count) {
    throw InvalidInput(std::to_string(count) + " points but sensors of " + std::to_string(hints.sensor_of_point.size()));
  }
  for (const std::uint32_t sensor : hints.sensor_of_point) {
    if (sensor != kNoSensor && sensor >= hints.sensors.size()) {
      throw InvalidInput("a point names sensor " + std::to_string(sensor) + ", but there are " + std::to_string(hints.sensors.size()));
    }
  }
}

}  // namespace g3r
