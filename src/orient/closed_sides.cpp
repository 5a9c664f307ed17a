#include "orient/closed_sides.h"

#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "orient/confidence.h"
#include "orient/settings.h"
#include "sum/direct_sum.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace g3r {
namespace {

// Winding number of a closed part about a place inside it, at least: the middle between the 0 of the outside and the 1/2 of a street, half
// of which is open.
constexpr double kInsideWinding = 0.5 / 2;

// Winding numbers of the closed parts at some places.
std::vector<double> winding_at(const HintedCloud& cloud, const std::vector<Vec3>& places, const std::atomic<bool>* cancel) {
  std::vector<Vec3> eta = cloud.sided.eta;
  for (std::size_t i = 0; i < eta.size(); ++i) {
    if (!cloud.patches.is_closed(i)) eta[i] = {0, 0, 0};
  }
  return direct_sum::winding(cloud.points, kRefinementWidth * cloud.spacing, eta, places, cancel);
}

// Whether closed parts reach so far along every axis that what stands in the cloud stands in them.
bool spans_cloud(const HintedCloud& cloud) {
  vector::Box all;
  vector::Box closed;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    all.extend(cloud.points[i]);
    if (cloud.patches.is_closed(i)) closed.extend(cloud.points[i]);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(closed.high[a] - closed.low[a] >= kClearlyLess * (all.high[a] - all.low[a]))) return false;
  }
  return true;
}

bool is_inside(double winding) { return winding >= kInsideWinding; }

// Share of the sensors that stand inside closed parts: of many, which are along a path, 500 at most stand for all.
double share_of_sensors_inside(const HintedCloud& cloud, const std::atomic<bool>* cancel) {
  const std::vector<Vec3>& sensors = cloud.hints.sensors;
  if (sensors.empty()) return 0;
  std::vector<Vec3> some;
  const std::size_t step = (sensors.size() + kFewPlaces - 1) / kFewPlaces;
  for (std::size_t s = 0; s < sensors.size(); s += step) some.push_back(sensors[s]);
  double inside = 0;
  for (const double w : winding_at(cloud, some, cancel)) inside += is_inside(w) ? 1 : 0;
  return inside / static_cast<double>(some.size());
}

// `votes`: of the sensors, on all closed parts together.
void judge_by_sensors(const HintedCloud& cloud, const Votes& votes, HintEffect& effect, const std::atomic<bool>* cancel) {
  const bool each_known = !cloud.hints.sensor_of_point.empty();
  const double inside = share_of_sensors_inside(cloud, cancel);
  bool against = each_known ? votes.share_against() >= kMostOf : is_majority(inside, 1);
  // From outside a closed part, as much of it is seen from behind as from the front: only sensors inside, or those of the points, object.
  if (each_known || inside > 0) effect.contradicted_share = votes.share_against() > 1 - kMostOf ? votes.share_against() : 0;
  if (cloud.hints.seen_from_inside) {
    against = against || inside > 0 || spans_cloud(cloud);
    effect.contradicted_share = 0;
  }
  if (!against) return;
  effect.closed_parts_turned = true;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (cloud.patches.is_closed(i)) effect.turned[i] = 1;
  }
}

// Of the cosines under which the sensors that may have seen a point see its front, the one nearest to edge-on where they have one sign: of
// the other side it has the other sign. 0 where they do not, and where none may have seen it.
double seen_by_all(const HintedCloud& cloud, std::size_t i, const Vec3& normal) {
  const Hints& hints = cloud.hints;
  if (!hints.sensor_of_point.empty()) {
    const std::uint32_t sensor = hints.sensor_of_point[i];
    return sensor == kNoSensor ? 0 : seen_from(hints.sensors[sensor], cloud.points[i], normal);
  }
  if (hints.sensors.empty()) return 0;
  double least = 1, most = -1;
  for (const Vec3& sensor : hints.sensors) {
    const double seen = seen_from(sensor, cloud.points[i], normal);
    least = std::min(least, seen);
    most = std::max(most, seen);
    if (least < 0 && most > 0) return 0;
  }
  return most < 0 ? most : least;
}

// `right`, how often the sensors agree with the sides of such points, is the chance of a side before its own vote.
void face_sensors(const HintedCloud& cloud, const Voters& voters, HintEffect& effect) {
  std::vector<std::uint32_t> unsure;
  std::vector<double> seen;
  Votes votes;
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.patches.is_closed(i) || cloud.sided.confidence[i] >= kUndecided) continue;
    unsure.push_back(i);
    seen.push_back((effect.turned[i] != 0 ? -1 : 1) * voters.trusted(i) * seen_by_all(cloud, i, cloud.sided.normals[i]));
    votes.add(seen.back());
  }
  const double right = 1 - votes.share_against();
  for (std::size_t k = 0; k < unsure.size(); ++k) {
    if (seen[k] == 0) continue;
    const double side = both_say(right, (1 + seen[k]) / 2);
    if (side < kUndecided) effect.turned[unsure[k]] ^= 1;
    const double chance = std::min(std::max(side, 1 - side), (1 + std::abs(seen[k])) / 2);
    if (chance >= kMostOf) cloud.sided.confidence[unsure[k]] = static_cast<float>(chance);
  }
}

}  // namespace

std::vector<std::size_t> inside_no_closed_part(const HintedCloud& cloud, const std::atomic<bool>* cancel) {
  const std::vector<Vec3>& places = cloud.hints.inside;
  std::vector<std::size_t> outside;
  if (places.empty()) return outside;
  const std::vector<double> winding = winding_at(cloud, places, cancel);
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (!is_inside(winding[k])) outside.push_back(k);
  }
  return outside;
}

void judge_closed_parts(const HintedCloud& cloud, Voters& voters, HintEffect& effect, const std::atomic<bool>* cancel) {
  Votes votes;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.patches.is_closed(i)) continue;
    votes.add(voters.seen(i, cloud.sided.normals[i]));
  }
  if (votes.total() > 0 || cloud.hints.seen_from_inside) judge_by_sensors(cloud, votes, effect, cancel);
  face_sensors(cloud, voters, effect);
}

}  // namespace g3r
