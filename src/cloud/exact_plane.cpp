#include "cloud/exact_plane.h"

#include "base/vector.h"
#include "cloud/plane_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace g3r {
namespace {

constexpr std::size_t kSeeds = 10;  // nearest others that candidates pass through
constexpr int kFewest = 6;          // points on a plane, itself included
// Within what distance, in spacings, kFewest points, one more, or two or more lie: so few by chance on one in a thousand planes through
// points that scatter by a third of a spacing.
constexpr std::array<double, 3> kWithin{0.0005, 0.002, 0.003};
constexpr double kSteepest = 0.1;    // cosine between a candidate and the direction asked for
constexpr double kNarrowest = 0.15;  // breadth of the points on the plane
constexpr double kLeastAngle = 0.1;  // sine, between the two that a candidate passes through

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

Candidate best_plane(const Around& around, const Vec3* towards) {
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
      if (cosine < kSteepest) continue;
      Candidate found = held_by(around, vector::scale(across, 1 / size));
      found.cosine = cosine;
      if (found.held > best.held || (found.held > 0 && found.held == best.held && found.cosine > best.cosine)) best = found;
    }
  }
  return best;
}

}  // namespace

ExactPlane find_exact_plane(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing, const Vec3* towards) {
  Around around;
  around.count = std::min(index.size(), kPlaneNeighbours);
  for (std::size_t k = 0; k < around.count; ++k) {
    const Vec3 d = vector::subtract(points[index[k]], points[index[0]]);
    around.x[k] = static_cast<float>(d[0] / spacing);
    around.y[k] = static_cast<float>(d[1] / spacing);
    around.z[k] = static_cast<float>(d[2] / spacing);
  }
  const Candidate best = best_plane(around, towards);
  if (best.held == 0) return {};
  ExactPlane plane;
  for (std::size_t k = 0; k < around.count; ++k) {
    if (std::abs(vector::dot(best.normal, around.at(k))) <= best.within) plane.points.push_back(index[k]);
  }
  if (plane.points.size() < static_cast<std::size_t>(kFewest)) return {};  // rounding
  const PlaneFit fit = fit_plane(points, plane.points.data(), plane.points.size());
  if (fit.breadth < kNarrowest) return {};
  plane.normal = fit.normal;
  plane.breadth = fit.breadth;
  return plane;
}

}  // namespace g3r
