#include "mesh/field_corners.h"

#include "base/median.h"
#include "cloud/canonical_cloud.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <algorithm>
#include <cmath>

namespace g3r::mesh {
namespace {

// The distance in spacings from the nearest point within which the fitted surface gives the side: half of that at which it is a guess, as
// farther away it bends off by itself. With 1.4 thin plates of 5,000 points have a genus of 52 instead of 3.
constexpr double kLocalReach = kFarSpacings / 2;
// The corners of which more than the side is in memory at the same time.
constexpr std::size_t kCornersAtOnce = 512 * parallel::kSmallBlock;

}  // namespace

struct CornerSides::Place {
  enum Kind : std::uint8_t { kSure, kAmbiguous, kUnknown, kUnwanted };
  Kind kind = kSure;
  bool unjoined = false;  // what the fit says is a guess
  float value = 0;
  float signed_value = 0;
  std::array<float, 3> axis{};
};

CornerSides::CornerSides(const LocalFit& local, const FieldSampler& sampler, double typical, const Cube& cube,
                         const std::vector<Vec3>& places, std::size_t asked_at_once)
    : local_(local), sampler_(sampler), spacing_(typical), cube_(cube), asked_at_once_(std::max(kCornersAtOnce, asked_at_once)) {
  reach_ = cube_.side / kBoxSide;  // fast sums end there, and single ones are slow
  std::vector<double> field;
  sampler_.sample(places, field, nullptr);
  level_ = median(std::move(field));
}

Corners CornerSides::of(const Octree& octree, const std::function<bool(std::uint32_t)>& wanted, const std::atomic<bool>* cancel) const {
  Corners corners;
  corners.value.resize(octree.corner_count());
  std::vector<Place> places;
  std::vector<Asked> asked;
  for (std::size_t first = 0; first < corners.value.size(); first += kCornersAtOnce) {
    places.resize(std::min(corners.value.size() - first, kCornersAtOnce));
    parallel::for_blocks(
        places.size(), parallel::kSmallBlock,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            if (wanted(static_cast<std::uint32_t>(first + i))) {
              places[i] = fit_at(octree.corner_position(first + i));
            } else {
              places[i].kind = Place::kUnwanted;
              places[i].value = static_cast<float>(-spacing_);
            }
          }
        },
        cancel);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto c = static_cast<std::uint32_t>(first + i);
      const Place& place = places[i];
      corners.value[c] = place.value;
      if (place.kind == Place::kUnknown) asked.push_back({c, kNotAmbiguous, false});
      if (place.kind != Place::kAmbiguous) continue;
      asked.push_back({c, static_cast<std::uint32_t>(corners.ambiguous.corner.size()), place.unjoined});
      corners.ambiguous.add(c, place.signed_value, place.axis);
    }
    if (asked.size() < asked_at_once_) continue;
    ask_field(octree, asked, corners);
    asked.clear();
  }
  ask_field(octree, asked, corners);
  return corners;
}

CornerSides::Place CornerSides::fit_at(const Vec3& at) const {
  const Eigen::Vector3d x(at[0], at[1], at[2]);
  const LocalSurface fit = local_.fit(x, kLocalReach, nullptr, LocalFit::Detail::kSide);
  Place place;
  if (fit.count == 0) {
    place.kind = is_beyond(at) ? Place::kSure : Place::kUnknown;
    place.value = static_cast<float>(-spacing_);
    return place;
  }
  const double value = -fit.distance(x);
  place.value = static_cast<float>(value);
  if (fit.simple) return place;
  place.kind = Place::kAmbiguous;
  place.unjoined = fit.unjoined;
  // The field adds 2 (w - level). The fit adds so much that the two weigh alike where the field is sure, and all of it from kDiscHalf
  // spacings away on, as the surface curves by no more.
  place.signed_value = static_cast<float>(2 * kFieldSure * std::clamp(value / (kDiscHalf * fit.spacing), -1.0, 1.0));
  for (std::size_t a = 0; a < 3; ++a) place.axis[a] = static_cast<float>(fit.patch[0].frame(2, static_cast<Eigen::Index>(a)));
  return place;
}

void CornerSides::ask_field(const Octree& octree, const std::vector<Asked>& asked, Corners& corners) const {
  std::vector<Vec3> queries(asked.size());
  for (std::size_t k = 0; k < asked.size(); ++k) queries[k] = octree.corner_position(asked[k].corner);
  std::vector<double> field;
  sampler_.sample(queries, field, nullptr);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const double f = field[k] - level_;
    float& value = corners.value[asked[k].corner];
    const bool known = asked[k].ambiguous != kNotAmbiguous;
    const double sure = asked[k].unjoined ? 0 : kFieldSure;
    if (!known || (std::abs(f) >= sure && (value > 0) != (f > 0))) value = static_cast<float>(f * spacing_);
    if (!known) continue;
    float& signed_value = corners.ambiguous.value[asked[k].ambiguous];
    signed_value = static_cast<float>(std::clamp(2 * f + signed_value, -1.0, 1.0));
  }
}

bool CornerSides::is_beyond(const Vec3& x) const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::abs(x[a] - cube_.centre[a]) > reach_) return true;
  }
  return false;
}

std::vector<std::uint8_t> sides_by_fit(const LocalFit& local, const std::vector<Vec3>& places) {
  std::vector<std::uint8_t> inside(places.size());
  parallel::for_blocks(places.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d x(places[i][0], places[i][1], places[i][2]);
      const LocalSurface fit = local.fit(x, kLocalReach, nullptr, LocalFit::Detail::kSide);
      inside[i] = fit.count > 0 && fit.distance(x) < 0 ? 1 : 0;
    }
  });
  return inside;
}

bool is_held(const LocalFit& local, const Vec3& inside, const Vec3& outside) {
  const Eigen::Vector3d a(inside[0], inside[1], inside[2]), b(outside[0], outside[1], outside[2]), direction = (b - a).normalized();
  const LocalSurface fit = local.fit((a + b) / 2, kFarSpacings, &direction);
  const auto parts = [&](const QuadraticPatch& patch) { return patch.distance(a) < 0 && patch.distance(b) > 0; };
  return std::any_of(fit.patch.begin(), fit.patch.begin() + fit.count, parts);
}

void match_values(const Octree& octree, const std::vector<std::uint8_t>& inside, double typical, std::vector<float>& value) {
  for (std::size_t c = 0; c < inside.size(); ++c) {
    if ((value[c] > 0) != (inside[c] != 0) && !octree.on_boundary(c))
      value[c] = static_cast<float>((inside[c] != 0 ? kAtOnePlace : -kAtOnePlace) * typical);
  }
}

}  // namespace g3r::mesh
