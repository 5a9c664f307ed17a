#include "orient/creases.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace g3r {
namespace {

// Standard deviation, in spacings, of the distance up to which the plane of another point holds a point: more lets in what is beyond a
// crease, less leaves out what is on the plane.
constexpr double kPlaneDeviation = 0.05;
// Rounds of averaging: the first one is still among blurred normals, and after it alone CAD models do not differ from others by the share
// below.
constexpr int kAveragings = 2;
// The median share of the weight that planes leave, from which a cloud is piecewise smooth: CAD models have 0.59 to 0.71, others at most
// 0.56.
constexpr double kPiecewiseSmooth = 0.58;

struct Averaged {
  std::vector<Vec3> normals;
  std::vector<double> share;  // of the weight that planes leave, at creases; -1 elsewhere
};

// One round of sharpen_creases().
Averaged average_in_planes(const PointSet& set, const std::vector<Vec3>& normals) {
  const std::vector<Vec3>& points = set.points();
  const std::vector<double>& spacing = set.smoothed_spacing();
  const std::vector<std::uint32_t>& near = set.near();
  Averaged out{normals, std::vector<double>(points.size(), -1)};
  parallel::for_blocks(points.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double deviation = kPlaneDeviation * spacing[i];
      const double radius = kWeightReach * spacing[i];
      double least = 1;
      double all = 0;
      double held = 0;
      Vec3 sum{0, 0, 0};
      for (std::size_t k = 1; k < kSpacingNeighbours; ++k) {
        const std::uint32_t j = near[i * kSpacingNeighbours + k];
        const Vec3 d = vector::subtract(points[i], points[j]);
        const double nearness = std::exp(-vector::dot(d, d) / (2 * radius * radius));
        all += nearness;
        const double cosine = vector::dot(normals[i], normals[j]);
        if (cosine <= 0) continue;
        least = std::min(least, cosine);
        const double height = vector::dot(normals[j], d) / deviation;
        const double weight = nearness * std::exp(-height * height / 2);
        held += weight;
        sum = vector::add(sum, vector::scale(normals[j], weight));
      }
      if (least > kSamePatch || !(all > 0)) continue;
      out.share[i] = held / all;
      const Vec3 n = vector::normalised(sum);
      if (vector::dot(n, n) > 0) out.normals[i] = n;
    }
  });
  return out;
}

}  // namespace

bool sharpen_creases(const PointSet& set, std::vector<Vec3>& normals, const std::vector<std::uint8_t>& wanted) {
  if (set.size() < kSpacingNeighbours) return false;
  std::vector<Vec3> sharp = normals;
  for (int round = 0; round < kAveragings; ++round) sharp = average_in_planes(set, sharp).normals;
  std::vector<double> share = average_in_planes(set, sharp).share;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i] == 0) share[i] = -1;  // thinner than what is wanted, and rounded more
  }
  share.erase(std::remove(share.begin(), share.end(), -1.0), share.end());
  if (share.empty() || median(share) < kPiecewiseSmooth) return false;
  normals = std::move(sharp);
  return true;
}

}  // namespace g3r
