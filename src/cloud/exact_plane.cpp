#include "cloud/exact_plane.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/plane_fit.h"
#include "cloud/quadratic_patch.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace g3r {
namespace {

constexpr std::size_t kSeeds = 10;        // nearest others that candidates pass through
constexpr int kFewest = kQuadraticTerms;  // points on a plane: fewer are on a bend, too
// Within what distance, in spacings, kFewest points, one more, or two or more lie: so few by chance on one in a thousand planes through
// points that scatter by a third of a spacing.
constexpr std::array<double, 3> kWithin{0.0005, 0.002, kExactWithin};
constexpr double kLeastAngle = 0.1;  // sine, between the two that a candidate passes through
// Of points that scatter.
constexpr double kBackground = 1.5;    // spacings to either side that points on no plane fill, as far as 32 neighbours reach
constexpr double kFalseAlarms = 1e-3;  // expected number of planes by chance, of all candidates
constexpr double kMostScatter = 0.15;  // spacings: with more, half of 33 points prove nothing
constexpr int kRefits = 2;             // the candidate passes through three points, so it is tilted by their scatter

// The nearest points of one, relative to it, itself first, in spacings.
struct Around {
  std::array<float, kPlaneNeighbours> x{}, y{}, z{};
  std::size_t count = 0;

  [[nodiscard]] Vec3 at(std::size_t k) const { return {x[k], y[k], z[k]}; }

  // How many a plane through the first holds to within a distance.
  [[nodiscard]] int held(const Vec3& normal, double within) const {
    const auto a = static_cast<float>(normal[0]);
    const auto b = static_cast<float>(normal[1]);
    const auto c = static_cast<float>(normal[2]);
    const auto most = static_cast<float>(within);
    int sum = 0;
    for (std::size_t k = 0; k < kPlaneNeighbours; ++k) sum += std::abs(a * x[k] + b * y[k] + c * z[k]) <= most ? 1 : 0;
    return sum - static_cast<int>(kPlaneNeighbours - count);  // those that are missing are at 0
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
  double within = 0;
  int held = 0;
  double cosine = 0;  // between its normal and the direction asked for
};

// The points that a plane through the first holds under the loosest of the bounds that it meets; none if it meets none.
Candidate held_by(const Around& around, const Vec3& normal) {
  for (std::size_t b = kWithin.size(); b-- > 0;) {
    const int held = around.held(normal, kWithin[b]);
    if (held < kFewest) break;
    if (held >= kFewest + static_cast<int>(b)) return {normal, kWithin[b], held, 0};
  }
  return {};
}

// How many of the candidates, planes through three of `count` points, hold k points or more by chance, k = 0 ... count, where each other
// point is within `within` of one with the probability of kBackground: a binomial tail.
std::vector<double> false_alarms(std::size_t count, double within) {
  const double chance = within / kBackground;
  const double candidates = kSeeds * (kSeeds - 1) / 2.0;
  std::vector<double> expected(count + 1, candidates);
  const std::size_t others = count < 3 ? 0 : count - 3;
  double tail = 0;
  double term = std::pow(chance, static_cast<double>(others));  // of all others
  for (std::size_t k = others; k > 0; --k) {
    tail += term;
    expected[k + 3] = candidates * tail;
    term *= static_cast<double>(k) * (1 - chance) / (static_cast<double>(others - k + 1) * chance);
  }
  return expected;
}

// How many points prove a plane.
int proof(std::size_t count, double within) {
  const std::vector<double> expected = false_alarms(count, within);
  const auto first = std::find_if(expected.begin(), expected.end(), [](double e) { return e <= kFalseAlarms; });
  return std::max(static_cast<int>(first - expected.begin()), kFewest + 1);
}

template <typename HeldBy>
Candidate best_plane(const Around& around, const Vec3* towards, const HeldBy& held_by) {
  Candidate best;
  const std::size_t seeds = std::min(kSeeds + 1, around.count);
  for (std::size_t a = 1; a < seeds; ++a) {
    for (std::size_t b = a + 1; b < seeds; ++b) {
      const Vec3 first = around.at(a);
      const Vec3 second = around.at(b);
      const Vec3 across = vector::cross(first, second);
      const double size = std::sqrt(vector::dot(across, across));
      if (!(size > kLeastAngle * std::sqrt(vector::dot(first, first) * vector::dot(second, second)))) continue;
      const double cosine = towards != nullptr ? std::abs(vector::dot(across, *towards)) / size : 1;
      Candidate found = held_by(vector::scale(across, 1 / size));
      found.cosine = cosine;
      if (found.held > best.held || (found.held > 0 && found.held == best.held && found.cosine > best.cosine)) best = found;
    }
  }
  return best;
}

// Whether a quadratic height field over the plane through these points is likelier than the plane (Schwarz's criterion).
bool is_bent(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& held, const PlaneFit& plane, double spacing) {
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
  if (held.points.size() < static_cast<std::size_t>(kFewest)) return {};  // rounding
  held.middle = vector::scale(held.middle, 1 / static_cast<double>(held.points.size()));
  held.fit = fit_plane(points, held.points.data(), held.points.size());
  return held;
}

}  // namespace

ExactPlane find_exact_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing, const Vec3* towards) {
  const Around around = around_first(points, index, spacing);
  const Candidate best = best_plane(around, towards, [&](const Vec3& normal) { return held_by(around, normal); });
  if (best.held == 0) return {};
  const Held held = fit_to_held(points, index, around, best.normal, {0, 0, 0}, best.within);
  return held.fit.breadth < kLineBreadth ? ExactPlane{} : held.plane();
}

ExactPlane find_scattered_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing, double scatter,
                                const Vec3& towards) {
  if (scatter > kMostScatter * spacing) return {};
  const Around around = around_first(points, index, spacing);
  const double within = kSigmas * scatter / spacing;
  const int needed = proof(around.count, within);
  if (around.count < static_cast<std::size_t>(needed)) return {};
  const Candidate best = best_plane(around, &towards, [&](const Vec3& normal) {
    const int held = around.held(normal, within);
    return held >= needed ? Candidate{normal, within, held, 0} : Candidate{};
  });
  if (best.held == 0) return {};
  Held held;
  held.fit.normal = best.normal;
  for (int fit = 0; fit <= kRefits; ++fit) {
    held = fit_to_held(points, index, around, held.fit.normal, held.middle, within);
    if (static_cast<int>(held.points.size()) < needed || held.points.front() != index[0]) return {};
  }
  return held.fit.breadth < kLineBreadth || is_bent(points, held.points, held.fit, spacing) ? ExactPlane{} : held.plane();
}

LikeliestPlane find_likeliest_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing) {
  const Around around = around_first(points, index, spacing);
  LikeliestPlane found;
  double least = kFalseAlarms;
  for (double scatter = kExactScatter; scatter < kMostScatter; scatter *= 2) {
    const double within = kSigmas * scatter;
    const Candidate best = best_plane(around, nullptr, [&](const Vec3& normal) {
      return Candidate{normal, within, around.held(normal, within), 0};
    });
    if (best.held <= kFewest) continue;
    const double expected = false_alarms(around.count, within)[static_cast<std::size_t>(best.held)];
    if (expected >= least) continue;
    const Held held = fit_to_held(points, index, around, best.normal, {0, 0, 0}, within);
    if (held.points.size() <= static_cast<std::size_t>(kFewest)) continue;  // rounding
    if (held.fit.breadth < kFacetBreadth || is_bent(points, held.points, held.fit, spacing)) continue;
    least = expected;
    found = {held.plane(), scatter};
  }
  return found;
}

}  // namespace g3r
