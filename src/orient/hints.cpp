#include "orient/hints.h"

#include "base/disjoint_sets.h"
#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/neighbours.h"
#include "orient/settings.h"
#include "sum/direct_sum.h"

#include <g3r/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>

namespace g3r {
namespace {

using vector::dot;
using vector::normalised;
using vector::subtract;

// Of the votes, a majority that noise, hidden and grazing points do not make; less against a side is no contradiction.
constexpr double kMostOf = 2.0 / 3;
// Winding number of a closed part about a place inside it, at least: a street, half of it open, has about 1/2.
constexpr double kInsideWinding = 0.25;
// Cosines a and -b under which one place sees two points of one smooth patch multiply to sin^2 of half the angle between their normals at
// most: where they object more, the points are on surfaces of their own.
constexpr double kMostOpposed = (1 - kSamePatch) / 2;
// Of the cloud's extent along every axis, what closed parts span that surround the scanner.
constexpr double kSpan = 0.5;

struct Votes {
  double in_favour = 0;
  double against = 0;
  std::size_t points = 0;

  void add(double vote) {
    in_favour += std::max(vote, 0.0);
    against += std::max(-vote, 0.0);
  }
  [[nodiscard]] double total() const { return in_favour + against; }
  // Seen edge-on, rounding alone votes.
  [[nodiscard]] bool count() const { return total() > std::numeric_limits<float>::epsilon() * static_cast<double>(points); }
  [[nodiscard]] double share_against() const { return total() > 0 ? against / total() : 0; }
};

// Cosine under which a place sees the front of a point; 0 from the point itself.
double seen_from(const Vec3& place, const Vec3& point, const Vec3& normal) { return dot(normal, normalised(subtract(place, point))); }

// The nearest of a few places, or nothing if there is none.
class NearestPlace {
 public:
  explicit NearestPlace(const std::vector<Vec3>& places) : places_(places) {
    if (!places.empty()) neighbours_.emplace(places_);
  }
  [[nodiscard]] const Vec3* to(const Vec3& point) {
    if (!neighbours_) return nullptr;
    neighbours_->nearest(point, 1, index_, squared_);
    return &places_[index_[0]];
  }

 private:
  const std::vector<Vec3>& places_;
  std::optional<Neighbours> neighbours_;
  std::vector<std::uint32_t> index_;
  std::vector<double> squared_;
};

// Votes of single points.
class Voters {
 public:
  Voters(const std::vector<Vec3>& points, const Hints& hints)
      : points_(points), hints_(hints), viewers_(hints.sensors), sensors_(viewers_), inside_(hints.inside) {
    if (hints.up) up_ = normalised(*hints.up);
    // It turns with the cloud, lies in the plane of a flat one, and is where a scanner inside, about which points are dense, stands.
    if (hints.seen_from_inside && hints.sensors.empty()) middle_ = vector::mean(points);
  }

  // What a sensor, or the middle that stands for one, says of a point.
  [[nodiscard]] double seen(std::size_t i, const Vec3& normal) {
    if (middle_) return seen_from(*middle_, points_[i], normal);
    if (!hints_.sensor_of_point.empty()) {
      const std::uint32_t sensor = hints_.sensor_of_point[i];
      return sensor == kNoSensor ? 0 : seen_from(viewers_[sensor], points_[i], normal);
    }
    const Vec3* sensor = sensors_.to(points_[i]);
    return sensor == nullptr ? 0 : seen_from(*sensor, points_[i], normal);
  }

  // What all hints say of it together.
  [[nodiscard]] double vote(std::size_t i, const Vec3& normal) {
    double sum = seen(i, normal);
    if (up_) sum += dot(normal, *up_);
    if (const Vec3* inside = inside_.to(points_[i])) sum -= seen_from(*inside, points_[i], normal);
    return sum;
  }

 private:
  const std::vector<Vec3>& points_;
  const Hints& hints_;
  const std::vector<Vec3>& viewers_;
  NearestPlace sensors_;
  NearestPlace inside_;
  std::optional<Vec3> up_;
  std::optional<Vec3> middle_;
};

// One call of follow_hints().
class Following {
 public:
  Following(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near, double spacing, const Patches& patches,
            const Hints& hints, const SidedPoints& sided, const std::atomic<bool>* cancel)
      : points_(points),
        near_(near),
        spacing_(spacing),
        patches_(patches),
        hints_(hints),
        sided_(sided),
        cancel_(cancel),
        voters_(points, hints) {}

  HintEffect follow() {
    effect_.decided.assign(points_.size(), 0);
    effect_.turned.assign(points_.size(), 0);
    decide_patches();
    judge_closed_parts();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if ((effect_.turned[i] != 0) != hints_.flip) turn(i);
    }
    return std::move(effect_);
  }

 private:
  [[nodiscard]] bool is_closed(std::size_t i) const { return patches_.of.empty() || patches_.of[i] == Patches::kNone; }
  [[nodiscard]] bool is_choice(std::size_t i) const { return !patches_.is_choice.empty() && patches_.is_choice[i] != 0; }

  void turn(std::size_t i) {
    for (double& c : sided_.normals[i]) c = -c;
    for (double& c : sided_.eta[i]) c = -c;
  }

  // The votes on every patch, as its points are turned by now.
  [[nodiscard]] std::map<std::uint32_t, Votes> votes_on_patches(const std::vector<double>& votes) const {
    std::map<std::uint32_t, Votes> sums;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_closed(i)) continue;
      Votes& sum = sums[patches_.of[i]];
      sum.add(effect_.turned[i] != 0 ? -votes[i] : votes[i]);
      ++sum.points;
    }
    return sums;
  }

  void decide_patches() {
    std::vector<double> votes(points_.size(), 0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!is_closed(i)) votes[i] = voters_.vote(i, sided_.normals[i]);
    }
    std::map<std::uint32_t, Votes> patches = votes_on_patches(votes);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_closed(i) || !patches[patches_.of[i]].count()) continue;
      const double against = patches[patches_.of[i]].share_against();
      effect_.turned[i] = is_choice(i) ? against > 0.5 : against >= kMostOf;
    }
    turn_pieces(votes);
    patches = votes_on_patches(votes);
    double agreed = 0;
    double all = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!is_choice(i) || is_closed(i) || !patches[patches_.of[i]].count()) continue;
      const double agreement = 1 - patches[patches_.of[i]].share_against();
      effect_.decided[i] = agreement >= kMostOf ? 1 : 0;
      sided_.confidence[i] = static_cast<float>(agreement) * (patches_.agreed.empty() ? 1 : patches_.agreed[i]);
      if (effect_.decided[i] == 0) continue;
      agreed += agreement;
      ++all;
    }
    if (all > 0) effect_.agreement = agreed / all;
    judge_backs();
  }

  // Body of a loop over the pairs of adjacent points of one patch.
  template <class Body>
  void for_adjacent(const Body& body) const {
    const std::size_t stride = near_.size() / points_.size();
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (is_closed(i)) continue;
      for (std::size_t k = 1; k < stride; ++k) {
        const std::uint32_t j = near_[i * stride + k];
        if (!is_closed(j) && patches_.of[i] == patches_.of[j]) body(i, j);
      }
    }
  }

  [[nodiscard]] Vec3 normal(std::size_t i) const { return vector::scale(sided_.normals[i], effect_.turned[i] != 0 ? -1 : 1); }

  // Whether the sides of two adjacent points are consistent: along the edge d from one to the other
  //   n_i . (n_j - 2 (n_j . d) d / |d|^2)
  // is near 1, as it is on bends and at sharp edges too (Koenig and Gumhold, "Consistent propagation of normal orientations in point
  // clouds", VMV 2009).
  [[nodiscard]] bool consistent(std::uint32_t i, std::uint32_t j) const {
    const Vec3 d = normalised(subtract(points_[j], points_[i]));
    const Vec3 n = normal(j);
    return dot(normal(i), subtract(n, vector::scale(d, 2 * dot(n, d)))) > kSamePatch;
  }

  // Whether a sensor has seen the front of the one point and the back of the other, further from edge-on than a horizon is.
  [[nodiscard]] bool opposed(const Vec3& sensor_i, std::uint32_t i, const Vec3& sensor_j, std::uint32_t j) const {
    return -seen_from(sensor_i, points_[i], normal(i)) * seen_from(sensor_j, points_[j], normal(j)) > kMostOpposed;
  }

  // Whether they are so for all sensors that may have seen them. Up is no such fact: an eave has a lower side.
  [[nodiscard]] bool opposed(std::uint32_t i, std::uint32_t j) const {
    if (hints_.sensors.empty()) return false;
    if (hints_.sensor_of_point.empty()) {
      return std::all_of(hints_.sensors.begin(), hints_.sensors.end(), [&](const Vec3& sensor) { return opposed(sensor, i, sensor, j); });
    }
    const std::uint32_t of_i = hints_.sensor_of_point[i];
    const std::uint32_t of_j = hints_.sensor_of_point[j];
    return of_i != kNoSensor && of_j != kNoSensor && opposed(hints_.sensors[of_i], i, hints_.sensors[of_j], j);
  }

  // The largest cosine under which a sensor that may have seen a point sees its front, or the first that is not below 0; nothing where none
  // may have seen it.
  [[nodiscard]] std::optional<double> best_seen(std::uint32_t i) const {
    if (hints_.sensor_of_point.empty()) {
      std::optional<double> best;
      for (const Vec3& sensor : hints_.sensors) {
        best = std::max(best.value_or(-1), seen_from(sensor, points_[i], normal(i)));
        if (*best >= 0) break;
      }
      return best;
    }
    const std::uint32_t sensor = hints_.sensor_of_point[i];
    if (sensor == kNoSensor) return std::nullopt;
    return seen_from(hints_.sensors[sensor], points_[i], normal(i));
  }

  // A scanner sees fronts: what faces away from all that may have seen it has the wrong side or the wrong direction, so that the side is a
  // choice at a horizon, and certainly wrong where it would be seen squarely from behind. Where all have been seen, that is turned.
  void judge_backs() {
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const std::optional<double> seen = is_closed(i) ? std::nullopt : best_seen(i);
      if (!seen || *seen >= 0) continue;
      const bool squarely = patches_.seen && -*seen > std::sqrt(kMostOpposed);
      if (squarely) effect_.turned[i] ^= 1;
      sided_.confidence[i] = std::min(sided_.confidence[i], static_cast<float>((1 + (squarely ? -*seen : *seen)) / 2));
    }
  }

  // Two adjacent points are of one surface, which may be seen from behind beyond its horizon.
  [[nodiscard]] bool joined(std::uint32_t i, std::uint32_t j) const { return consistent(i, j) && !opposed(i, j); }

  // Where gaps or creases cut a patch into pieces that are not consistent with each other, those go over that two thirds of their votes are
  // against.
  void turn_pieces(std::vector<double> votes) {
    if (near_.empty()) return;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (effect_.turned[i] != 0) votes[i] = -votes[i];
    }
    DisjointSets pieces(points_.size());
    for_adjacent([&](std::uint32_t i, std::uint32_t j) {
      if (joined(i, j)) pieces.join(i, j);
    });
    turn_objecting(pieces, votes);
    turn_hardly_joined(votes);
  }

  // Of the pieces, what objects as a whole and hangs together with the rest by a few pairs of points only: in the crevice between a thing
  // and the ground, normals lead from the one to the inside of the other. It goes over if it has more votes than such pairs, and fewer
  // pairs than half of the rim of a disc of as many points.
  void turn_hardly_joined(const std::vector<double>& votes) {
    DisjointSets regions(points_.size());
    for_adjacent([&](std::uint32_t i, std::uint32_t j) {
      if (votes[i] < 0 && votes[j] < 0 && joined(i, j)) regions.join(i, j);
    });
    std::vector<double> seam(points_.size(), 0);
    for_adjacent([&](std::uint32_t i, std::uint32_t j) {
      if (!joined(i, j) || (votes[i] < 0) == (votes[j] < 0)) return;
      seam[regions.find(votes[i] < 0 ? i : j)] += 1;
    });
    const std::vector<Votes> sums = sums_of(regions, votes);
    const double links = static_cast<double>(near_.size()) / static_cast<double>(points_.size()) - 1;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const std::size_t region = regions.find(i);
      const double rim = links * std::sqrt(std::numbers::pi * static_cast<double>(sums[region].points));
      const bool squarely = sums[region].against > std::sqrt(kMostOpposed) * static_cast<double>(sums[region].points);
      if (votes[i] < 0 && squarely && sums[region].against > seam[region] && seam[region] < rim / 2) effect_.turned[i] ^= 1;
    }
  }

  [[nodiscard]] std::vector<Votes> sums_of(DisjointSets& sets, const std::vector<double>& votes) const {
    std::vector<Votes> sums(points_.size());
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      Votes& sum = sums[sets.find(i)];
      sum.add(votes[i]);
      ++sum.points;
    }
    return sums;
  }

  // Turns the pieces that two thirds of their votes are against, and the votes of their points.
  void turn_objecting(DisjointSets& pieces, std::vector<double>& votes) {
    const std::vector<Votes> sums = sums_of(pieces, votes);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const Votes& piece = sums[pieces.find(i)];
      if (is_closed(i) || !piece.count() || piece.share_against() < kMostOf) continue;
      effect_.turned[i] ^= 1;
      votes[i] = -votes[i];
    }
  }

  // Winding numbers of the closed parts at some places.
  [[nodiscard]] std::vector<double> winding_at(const std::vector<Vec3>& places) const {
    std::vector<Vec3> eta = sided_.eta;
    for (std::size_t i = 0; i < eta.size(); ++i) {
      if (!is_closed(i)) eta[i] = {0, 0, 0};
    }
    return direct_sum::winding(points_, kRefinementWidth * spacing_, eta, places, cancel_);
  }

  // Whether closed parts reach so far along every axis that what stands in the cloud stands in them.
  [[nodiscard]] bool spans_cloud() const {
    vector::Box all;
    vector::Box closed;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      all.extend(points_[i]);
      if (is_closed(i)) closed.extend(points_[i]);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      if (!(closed.high[a] - closed.low[a] >= kSpan * (all.high[a] - all.low[a]))) return false;
    }
    return true;
  }

  // Share of the sensors that stand inside closed parts. Of many, which are along a path, every so-manieth tells.
  [[nodiscard]] double share_of_sensors_inside() const {
    if (hints_.sensors.empty()) return 0;
    std::vector<Vec3> some;
    const std::size_t step = (hints_.sensors.size() + kFewPlaces - 1) / kFewPlaces;
    for (std::size_t s = 0; s < hints_.sensors.size(); s += step) some.push_back(hints_.sensors[s]);
    double inside = 0;
    for (const double w : winding_at(some)) inside += w >= kInsideWinding ? 1 : 0;
    return inside / static_cast<double>(some.size());
  }

  void judge_closed_parts() {
    Votes votes;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_closed(i)) votes.add(voters_.seen(i, sided_.normals[i]));
    }
    if (votes.total() > 0 || hints_.seen_from_inside) judge_by_sensors(votes);
    if (hints_.inside.empty() || std::none_of(points_.begin(), points_.end(),
                                              [this](const Vec3& p) { return is_closed(static_cast<std::size_t>(&p - points_.data())); })) {
      return;
    }
    const std::vector<double> winding = winding_at(hints_.inside);
    const auto least = std::min_element(winding.begin(), winding.end());
    if (*least < kInsideWinding) effect_.inside_that_is_outside = hints_.inside[static_cast<std::size_t>(least - winding.begin())];
  }

  void judge_by_sensors(const Votes& votes) {
    const bool each_known = !hints_.sensor_of_point.empty();
    const double inside = share_of_sensors_inside();
    bool against = each_known ? votes.share_against() >= kMostOf : inside > 0.5;
    // From outside a closed part, as much of it is seen from behind as from the front: only sensors inside, or those of the points, object.
    if (each_known || inside > 0) effect_.contradicted_share = votes.share_against() > 1 - kMostOf ? votes.share_against() : 0;
    if (hints_.seen_from_inside) {
      against = against || inside > 0 || spans_cloud();
      effect_.contradicted_share = 0;
    }
    if (!against) return;
    effect_.closed_parts_turned = true;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_closed(i)) effect_.turned[i] = 1;
    }
  }

  const std::vector<Vec3>& points_;
  const std::vector<std::uint32_t>& near_;
  double spacing_;
  const Patches& patches_;
  const Hints& hints_;
  SidedPoints sided_;
  const std::atomic<bool>* cancel_;
  Voters voters_;
  HintEffect effect_;
};

bool has_any(const Hints& hints) {
  return hints.up || !hints.sensors.empty() || !hints.inside.empty() || hints.seen_from_inside || hints.flip;
}

void require_finite(const std::vector<Vec3>& places, const std::string& name) {
  for (const Vec3& place : places) {
    if (!vector::is_finite(place)) throw InvalidInput("the hint " + name + " must be finite");
  }
}

}  // namespace

HintEffect follow_hints(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near, double spacing, const Patches& patches,
                        const Hints& hints, const SidedPoints& sided, const std::atomic<bool>* cancel) {
  if (!has_any(hints) || points.empty()) return {};
  return Following(points, near, spacing, patches, hints, sided, cancel).follow();
}

void require_sound(const Hints& hints, std::size_t count) {
  require_finite(hints.sensors, "sensor");
  require_finite(hints.inside, "inside");
  if (hints.up) {
    require_finite({*hints.up}, "up");
    if (normalised(*hints.up) == Vec3{0, 0, 0}) throw InvalidInput("the hint up must have a length above 0");
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
