#include "orient/patch_sides.h"

#include "base/disjoint_sets.h"
#include "base/vector.h"
#include "cloud/constants.h"
#include "orient/confidence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace g3r {
namespace {

using vector::dot;
using vector::normalised;
using vector::subtract;

// Cosines a and -b under which one place sees two points of one smooth patch multiply to sin^2 of half the angle between their normals at
// most: where they object more, the points are on surfaces of their own.
constexpr double kMostOpposed = (1 - kSamePatch) / 2;

// One call of decide_patches().
class PatchSides {
 public:
  PatchSides(const HintedCloud& cloud, Voters& voters, HintEffect& effect)
      : points_(cloud.points),
        near_(cloud.near),
        patches_(cloud.patches),
        hints_(cloud.hints),
        sided_(cloud.sided),
        over_others_(cloud.over_others),
        voters_(voters),
        effect_(effect) {}

  void decide() {
    std::vector<double> votes(points_.size(), 0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!is_closed(i)) votes[i] = voters_.vote(i, sided_.normals[i]);
    }
    std::map<std::uint32_t, Votes> patches = votes_on_patches(votes);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_closed(i) || !patches[patches_.of[i]].say_something()) continue;
      const double against = patches[patches_.of[i]].chance_against();
      effect_.turned[i] = against > std::min(certainty(i), kMostOf) ? 1 : 0;
    }
    const std::vector<std::uint8_t> patch_turned = effect_.turned;
    turn_pieces(votes);
    patches = votes_on_patches(votes);
    double agreed = 0;
    double all = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!is_choice(i) || is_closed(i) || !patches[patches_.of[i]].say_something()) continue;
      const double agreement = 1 - patches[patches_.of[i]].chance_against();
      const double shown = patch_turned[i] != 0 ? 1 - certainty(i) : certainty(i);
      const double own = effect_.turned[i] != 0 ? -votes[i] : votes[i];
      const bool with_patch = effect_.turned[i] == patch_turned[i];
      const double side =
          std::min(most_certain(i), std::max(both_agree(both_say(shown, agreement), with_patch ? held(i) : 1 - held(i)), chance(own)));
      sided_.confidence[i] = static_cast<float>(side) * (patches_.agreed.empty() ? 1 : patches_.agreed[i]);
      effect_.decided[i] = are_all_seen() || side >= kMostOf ? 1 : 0;
      if (effect_.decided[i] == 0) continue;
      agreed += agreement;
      ++all;
    }
    if (all > 0) effect_.agreement = agreed / all;
    judge_backs(patch_turned);
  }

 private:
  [[nodiscard]] bool is_closed(std::size_t i) const { return patches_.is_closed(i); }
  // Of the side that the points themselves show.
  [[nodiscard]] double certainty(std::size_t i) const { return patches_.certainty.empty() ? 1 : patches_.certainty[i]; }
  // Then a grazing view leaves a doubt, but no choice.
  [[nodiscard]] bool are_all_seen() const { return patches_.seen && !hints_.sensors.empty(); }
  [[nodiscard]] bool is_choice(std::size_t i) const { return certainty(i) < 1; }

  // As people say that a surface faces up of canopies, too, that have been seen from below.
  [[nodiscard]] double most_certain(std::size_t i) const { return !over_others_.empty() && over_others_[i] != 0 ? kMostOf : 1; }

  // Chance that a point has the side of the rest of its patch.
  [[nodiscard]] double held(std::size_t i) const { return patches_.held.empty() ? 1 : patches_.held[i]; }

  // Of the side of what this is the vote on, by itself.
  [[nodiscard]] double chance(double vote) const { return voters_.only_from_middle() ? kUndecided : (1 + std::min(vote, 1.0)) / 2; }

  // The votes on every patch, as its points are turned by now.
  [[nodiscard]] std::map<std::uint32_t, Votes> votes_on_patches(const std::vector<double>& votes) const {
    std::map<std::uint32_t, Votes> sums;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_closed(i)) continue;
      Votes& sum = sums[patches_.of[i]];
      sum.add(effect_.turned[i] != 0 ? -votes[i] : votes[i]);
      sum.trusted += voters_.trusted(i);
      ++sum.points;
    }
    return sums;
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
  [[nodiscard]] bool are_consistent(std::uint32_t i, std::uint32_t j) const {
    const Vec3 d = normalised(subtract(points_[j], points_[i]));
    const Vec3 n = normal(j);
    return dot(normal(i), subtract(n, vector::scale(d, 2 * dot(n, d)))) > kSamePatch;
  }

  // Whether a sensor has seen the front of the one point and the back of the other, further from edge-on than a horizon is.
  [[nodiscard]] bool are_opposed(const Vec3& sensor_i, std::uint32_t i, const Vec3& sensor_j, std::uint32_t j) const {
    return -seen_from(sensor_i, points_[i], normal(i)) * seen_from(sensor_j, points_[j], normal(j)) > kMostOpposed;
  }

  // Whether they are so for all sensors that may have seen them. Up is no such fact: an eave has a lower side.
  [[nodiscard]] bool are_opposed(std::uint32_t i, std::uint32_t j) const {
    if (hints_.sensors.empty()) return false;
    if (hints_.sensor_of_point.empty()) {
      return std::all_of(hints_.sensors.begin(), hints_.sensors.end(),
                         [&](const Vec3& sensor) { return are_opposed(sensor, i, sensor, j); });
    }
    const std::uint32_t of_i = hints_.sensor_of_point[i];
    const std::uint32_t of_j = hints_.sensor_of_point[j];
    return of_i != kNoSensor && of_j != kNoSensor && are_opposed(hints_.sensors[of_i], i, hints_.sensors[of_j], j);
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
  // choice at a horizon, and certainly wrong where it would be seen squarely from behind. Where all have been seen, that is turned, and
  // elsewhere what the rest of its patch does not hold more than that. All this so far as the sensors are trusted.
  void judge_backs(const std::vector<std::uint8_t>& patch_turned) {
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const std::optional<double> seen = is_closed(i) ? std::nullopt : best_seen(i);
      if (!seen || *seen >= 0) continue;
      const double trusted = voters_.trusted(i);
      const double holds = effect_.turned[i] == patch_turned[i] ? held(i) : 1 - held(i);
      const bool wrong = patches_.seen ? -*seen > std::sqrt(kMostOpposed) : holds + (1 + trusted * *seen) / 2 < 1;
      if (wrong) effect_.turned[i] ^= 1;
      const double chance = (1 + (wrong ? -*seen : *seen)) / 2;
      sided_.confidence[i] = std::min(sided_.confidence[i], static_cast<float>(1 - trusted * (1 - chance)));
    }
  }

  // Two adjacent points are of one surface, which may be seen from behind beyond its horizon.
  [[nodiscard]] bool are_joined(std::uint32_t i, std::uint32_t j) const { return are_consistent(i, j) && !are_opposed(i, j); }

  // Where gaps or creases cut a patch into pieces that are not consistent with each other, those go over that two thirds of their votes are
  // against.
  void turn_pieces(std::vector<double> votes) {
    if (near_.empty()) return;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (effect_.turned[i] != 0) votes[i] = -votes[i];
    }
    DisjointSets pieces(points_.size());
    for_adjacent([&](std::uint32_t i, std::uint32_t j) {
      if (are_joined(i, j)) pieces.join(i, j);
    });
    turn_objecting(pieces, votes);
    if (!voters_.only_from_middle()) turn_hardly_joined(votes);
  }

  // Of the pieces, what objects as a whole and hangs together with the rest by a few pairs of points only: in the crevice between a thing
  // and the ground, normals lead from the one to the inside of the other. It goes over if it has more votes than such pairs, and fewer
  // clearly fewer pairs than the rim of a disc of as many points.
  void turn_hardly_joined(const std::vector<double>& votes) {
    DisjointSets regions(points_.size());
    for_adjacent([&](std::uint32_t i, std::uint32_t j) {
      if (votes[i] < 0 && votes[j] < 0 && are_joined(i, j)) regions.join(i, j);
    });
    std::vector<double> seam(points_.size(), 0);
    for_adjacent([&](std::uint32_t i, std::uint32_t j) {
      if (!are_joined(i, j) || (votes[i] < 0) == (votes[j] < 0)) return;
      seam[regions.find(votes[i] < 0 ? i : j)] += 1;
    });
    const std::vector<Votes> sums = sums_of(regions, votes);
    const double links = static_cast<double>(near_.size()) / static_cast<double>(points_.size()) - 1;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const std::size_t region = regions.find(i);
      const double rim = links * std::sqrt(std::numbers::pi * static_cast<double>(sums[region].points));
      const bool squarely = sums[region].against > std::sqrt(kMostOpposed) * static_cast<double>(sums[region].points);
      if (votes[i] < 0 && squarely && sums[region].against > seam[region] && seam[region] < kClearlyLess * rim) effect_.turned[i] ^= 1;
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

  // Turns the pieces whose votes say more against their side than what holds them says for it, and the votes of their points: by the mean
  // vote v and the mean chance c that a point has the side of its patch, both_say((1 + v) / 2, c) is a half or less. The middle of a scene
  // only decides where nothing else does.
  void turn_objecting(DisjointSets& pieces, std::vector<double>& votes) {
    const std::vector<Votes> sums = sums_of(pieces, votes);
    std::vector<double> held_of(points_.size(), 0);
    for (std::uint32_t i = 0; i < points_.size(); ++i) held_of[pieces.find(i)] += held(i);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const std::size_t piece = pieces.find(i);
      const auto count = static_cast<double>(sums[piece].points);
      const double vote = (sums[piece].in_favour - sums[piece].against) / count;
      if (is_closed(i) || !sums[piece].say_something() || vote >= 0) continue;
      if (chance(vote) + held_of[piece] / count > 1) continue;
      effect_.turned[i] ^= 1;
      votes[i] = -votes[i];
    }
  }

  const std::vector<Vec3>& points_;
  const std::vector<std::uint32_t>& near_;
  const Patches& patches_;
  const Hints& hints_;
  SidedPoints sided_;
  const std::vector<std::uint8_t>& over_others_;
  Voters& voters_;
  HintEffect& effect_;
};

}  // namespace

void decide_patches(const HintedCloud& cloud, Voters& voters, HintEffect& effect) { PatchSides(cloud, voters, effect).decide(); }

}  // namespace g3r
