#include "orient/planes.h"

#include "cloud/plane_fit.h"
#include "cpu/parallel.h"
#include "mesh/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace g3r {
namespace {

constexpr std::size_t kNeighbours = 33;  // the point itself, first, and 32 others
constexpr std::size_t kSeeds = 10;       // nearest others that candidates pass through
constexpr int kFewest = 6;               // points on a plane, itself included
// Within what distance, in spacings, kFewest points, one more, or two or more lie: so few by chance on one in a thousand planes through
// points that scatter by a third of a spacing.
constexpr std::array<double, 3> kWithin{0.0005, 0.002, 0.003};
constexpr double kSteepest = 0.1;     // cosine between a candidate and the normal
constexpr double kNarrowest = 0.15;   // breadth of the points on the plane
constexpr double kLeastAngle = 0.1;   // sine, between the two that a candidate passes through
constexpr std::size_t kBlock = 1024;  // points per parallel block

// The nearest points of one, relative to it, itself first, in its spacings.
struct Around {
  std::array<float, kNeighbours> x{}, y{}, z{};
  std::size_t count = 0;

  [[nodiscard]] Vec3 at(std::size_t k) const { return {x[k], y[k], z[k]}; }

  // How many a plane through the first holds to within a distance.
  [[nodiscard]] int held(const Vec3& normal, double within) const {
    const auto a = static_cast<float>(normal[0]);
    const auto b = static_cast<float>(normal[1]);
    const auto c = static_cast<float>(normal[2]);
    const auto most = static_cast<float>(within);
    int sum = 0;
    for (std::size_t k = 0; k < kNeighbours; ++k) sum += std::abs(a * x[k] + b * y[k] + c * z[k]) <= most ? 1 : 0;
    return sum - static_cast<int>(kNeighbours - count);  // those that are missing are at 0
  }
};

struct Candidate {
  Vec3 normal{0, 0, 0};
  double within = 0;
  int held = 0;
  double cosine = 0;  // between its normal and the point's
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

Candidate best_plane(const Around& around, const Vec3& normal) {
  Candidate best;
  const std::size_t seeds = std::min(kSeeds + 1, around.count);
  for (std::size_t a = 1; a < seeds; ++a) {
    for (std::size_t b = a + 1; b < seeds; ++b) {
      const Vec3 first = around.at(a);
      const Vec3 second = around.at(b);
      const Vec3 across = vector::cross(first, second);
      const double size = std::sqrt(vector::dot(across, across));
      if (!(size > kLeastAngle * std::sqrt(vector::dot(first, first) * vector::dot(second, second)))) continue;
      const double cosine = vector::dot(across, normal) / size;
      if (std::abs(cosine) < kSteepest) continue;
      Candidate found = held_by(around, vector::scale(across, 1 / size));
      found.cosine = std::abs(cosine);
      if (found.held > best.held || (found.held > 0 && found.held == best.held && found.cosine > best.cosine)) best = found;
    }
  }
  return best;
}

}  // namespace

void fit_planes(const std::vector<Vec3>& points, const Neighbours& neighbours, const std::vector<double>& spacing,
                std::vector<std::uint8_t>& proven, std::vector<Vec3>& normals) {
  parallel::for_blocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    Around around;
    for (std::size_t i = begin; i < end; ++i) {
      if (proven[i] != 0) continue;
      neighbours.nearest(points[i], kNeighbours, index, squared);
      around = {};
      around.count = index.size();
      for (std::size_t k = 0; k < around.count; ++k) {
        const Vec3 d = vector::subtract(points[index[k]], points[i]);
        around.x[k] = static_cast<float>(d[0] / spacing[i]);
        around.y[k] = static_cast<float>(d[1] / spacing[i]);
        around.z[k] = static_cast<float>(d[2] / spacing[i]);
      }
      const Candidate best = best_plane(around, normals[i]);
      if (best.held == 0) continue;
      std::size_t held = 0;
      for (std::size_t k = 0; k < around.count; ++k) {
        if (std::abs(vector::dot(best.normal, around.at(k))) <= best.within) index[held++] = index[k];
      }
      if (held < static_cast<std::size_t>(kFewest)) continue;  // rounding
      const PlaneFit plane = fit_plane(points, index.data(), held);
      if (plane.breadth < kNarrowest) continue;
      proven[i] = 1;
      normals[i] = vector::scale(plane.normal, vector::dot(plane.normal, normals[i]) < 0 ? -1 : 1);
    }
  });
}

}  // namespace g3r
