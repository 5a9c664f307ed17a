#include "cloud/exact_plane.h"

#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/plane_fit.h"
#include "cloud/quadratic_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>

namespace g3r {
namespace {

// The nearest others, pairs of which candidates pass through: 55 pairs.
constexpr std::size_t kSeeds = kPatchNeighbours - 1;

// The nearest points of one, relative to it, itself first, in spacings.
struct Around {
  std::array<float, kPlaneNeighbours> x{}, y{}, z{};
  std::size_t count = 0;

  [[nodiscard]] Vec3 at(std::size_t k) const { return {x[k], y[k], z[k]}; }

  // How many a plane through the first holds to within a distance.
  [[nodiscard]] std::size_t held(const Vec3& normal, double within) const {
    const auto a = static_cast<float>(normal[0]);
    const auto b = static_cast<float>(normal[1]);
    const auto c = static_cast<float>(normal[2]);
    const auto most = static_cast<float>(within);
    int sum = 0;
    for (std::size_t k = 0; k < kPlaneNeighbours; ++k) sum += std::abs(a * x[k] + b * y[k] + c * z[k]) <= most ? 1 : 0;
    return static_cast<std::size_t>(sum) - (kPlaneNeighbours - count);  // those that are missing are at 0
  }

  // How many another plane, parallel to one through the first and at least four such distances away, holds at most.
  [[nodiscard]] std::size_t most_held_beside(const Vec3& normal, double within) const {
    std::vector<double> height;
    for (std::size_t k = 0; k < count; ++k) height.push_back(vector::dot(normal, at(k)));
    std::sort(height.begin(), height.end());
    std::size_t most = 0;
    std::size_t end = 0;
    for (std::size_t k = 0; k < count; ++k) {
      while (end < count && height[end] - height[k] <= 2 * within) ++end;
      if (height[k] >= 3 * within || height[end - 1] <= -3 * within) most = std::max(most, end - k);
    }
    return most;
  }
};

Around around_first(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing) {
  Around around;
  around.count = std::min(index.size(), kPlaneNeighbours);
  for (std::size_t k = 0; k < around.count; ++k) {
    const Vec3 d = vector::subtract(points[index[k]], points[index[0]]);
    around.x[k] = static_cast<float>(d[0] / spacing);
    around.y[k] = static_cast<float>(d[1] / spacing);
    around.z[k] = static_cast<float>(d[2] / spacing);
  }
  return around;
}

struct Candidate {
  Vec3 normal{0, 0, 0};
  std::size_t held = 0;
  double cosine = 0;  // between its normal and the direction asked for
};

// Share of the points that lie within `within` of a plane through one by chance, if they fill the ball that as many of a surface lie in.
double share_by_chance(double within) { return share_of_ball(within / std::sqrt(kPlaneNeighbours / std::numbers::pi)); }

// How many of `count` points, three of them those that it goes through, prove a plane. Of less than kQuadraticTerms none: they are on a
// bend, too. So many of exact ones prove it.
std::size_t proof(std::size_t count, double within) {
  const std::size_t others = count < 3 ? 0 : count - 3;
  const double pairs = kSeeds * (kSeeds - 1) / 2.0;
  return std::max(proving_number(others, share_by_chance(within), pairs) + 3, kQuadraticTerms);
}

// The candidate that holds most points to within a distance.
Candidate best_plane(const Around& around, const Vec3* towards, double within) {
  Candidate best;
  const std::size_t seeds = std::min(kSeeds + 1, around.count);
  for (std::size_t a = 1; a < seeds; ++a) {
    for (std::size_t b = a + 1; b < seeds; ++b) {
      const Vec3 across = vector::cross(around.at(a), around.at(b));
      const double size = std::sqrt(vector::dot(across, across));
      if (!(size > 0)) continue;
      const Vec3 normal = vector::scale(across, 1 / size);
      const double cosine = towards != nullptr ? std::abs(vector::dot(normal, *towards)) : 1;
      const std::size_t held = around.held(normal, within);
      if (held > best.held || (held == best.held && cosine > best.cosine)) best = {normal, held, cosine};
    }
  }
  return best;
}

// Whether a quadratic height field over the plane through these points is likelier than the plane (Schwarz's criterion). Of exact points
// both leave rounding, of which ratios say nothing.
bool is_bent(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& held, const PlaneFit& plane, double spacing) {
  if (held.size() <= kQuadraticTerms) return false;  // some quadratic goes through any six points
  if (plane.residual <= kExactScatter * spacing) return false;
  const auto n = static_cast<double>(held.size());
  const double flat = plane.residual * std::sqrt((n - kPlaneTerms) / n);  // root mean squares, of which the likelihoods are made
  const double bent = quadratic_residual(points, held.data(), held.size(), plane.normal, spacing) * std::sqrt((n - kQuadraticTerms) / n);
  return n * std::log(flat / bent) > (kQuadraticTerms - kPlaneTerms) * std::log(n) / 2;
}

// The points within `within` of a plane through a place, both relative to the first point and in spacings, and the plane fitted to them.
struct Held {
  std::vector<std::uint32_t> points;
  Vec3 middle{0, 0, 0};  // of them, in the same frame
  PlaneFit fit;

  [[nodiscard]] ExactPlane plane() const { return {points, fit.normal, fit.breadth}; }
};

Held fit_to_held(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, const Around& around, const Vec3& normal,
                 const Vec3& place, double within) {
  Held held;
  for (std::size_t k = 0; k < around.count; ++k) {
    const Vec3 at = around.at(k);
    if (std::abs(vector::dot(normal, vector::subtract(at, place))) > within) continue;
    held.points.push_back(index[k]);
    held.middle = vector::add(held.middle, at);
  }
  if (held.points.size() < kQuadraticTerms) return {};  // rounding
  held.middle = vector::scale(held.middle, 1 / static_cast<double>(held.points.size()));
  held.fit = fit_plane(points, held.points.data(), held.points.size());
  return held;
}

}  // namespace

ExactPlane find_exact_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing, const Vec3* towards) {
  const Around around = around_first(points, index, spacing);
  const Candidate best = best_plane(around, towards, kExactScatter);
  if (best.held < kQuadraticTerms) return {};
  const Held held = fit_to_held(points, index, around, best.normal, {0, 0, 0}, kExactScatter);
  return held.fit.breadth < kLineBreadth ? ExactPlane{} : held.plane();
}

std::vector<std::uint32_t> beside_plane(const std::vector<std::uint32_t>& index, const std::vector<std::uint32_t>& held) {
  std::vector<std::uint32_t> others{index.front()};
  std::copy_if(index.begin() + 1, index.end(), std::back_inserter(others),
               [&](std::uint32_t i) { return std::find(held.begin(), held.end(), i) == held.end(); });
  return others;
}

ExactPlane find_scattered_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing, double scatter,
                                const Vec3& towards) {
  const Around around = around_first(points, index, spacing);
  const double within = kSigmas * scatter / spacing;
  const std::size_t needed = proof(around.count, within);
  if (is_majority(static_cast<double>(needed), static_cast<double>(around.count))) return {};  // another plane may hold as many
  const Candidate best = best_plane(around, &towards, within);
  if (best.held < needed) return {};
  Held held;
  held.fit.normal = best.normal;
  for (std::size_t before = 0;;) {  // it passes through three points, so it is tilted by their scatter
    held = fit_to_held(points, index, around, held.fit.normal, held.middle, within);
    if (held.points.size() < needed || held.points.front() != index[0]) return {};
    if (held.points.size() <= before) break;
    before = held.points.size();
  }
  return held.fit.breadth < kLineBreadth || is_bent(points, held.points, held.fit, spacing) ? ExactPlane{} : held.plane();
}

LikeliestPlane find_likeliest_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing,
                                    const std::function<bool(const LikeliestPlane&)>& is_of_facet) {
  const Around around = around_first(points, index, spacing);
  LikeliestPlane found;
  double least = 1;
  for (double scatter = kExactScatter;; scatter *= kLevelRatio) {
    const double within = kSigmas * scatter;
    const std::size_t needed = proof(around.count, within);
    if (is_majority(static_cast<double>(needed), static_cast<double>(around.count))) break;
    const Candidate best = best_plane(around, nullptr, within);
    if (best.held < needed) continue;
    double chance = chances_of_as_many(around.count - 3, share_by_chance(within))[best.held - 3];
    if (const std::size_t other = around.most_held_beside(best.normal, within); other > kQuadraticTerms) {
      const std::vector<double> of_two = chances_of_as_many(around.count - 4, 2 * share_by_chance(within));
      chance = std::min(chance, static_cast<double>(around.count - 3) * of_two[best.held + other - 4]);
    }
    if (chance >= least) continue;
    const Held held = fit_to_held(points, index, around, best.normal, {0, 0, 0}, within);
    if (held.points.size() <= kQuadraticTerms) continue;  // is_bent() cannot tell
    if (held.fit.breadth < kClearlyLess || is_bent(points, held.points, held.fit, spacing)) continue;
    const LikeliestPlane likelier{held.plane(), scatter};
    if (!is_of_facet(likelier)) continue;
    least = chance;
    found = likelier;
  }
  return found;
}

}  // namespace g3r
