#include "mesh/crossings.h"

#include "base/degrees.h"
#include "base/median.h"
#include "base/vector.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace g3r::mesh {
namespace {

using vector::dot;

// The points around the line that are looked at: those of an X within 3.5 spacings. Fewer are few in each half, and farther surfaces curve.
constexpr std::size_t kAround = 5 * kFitPoints;
// A point is on a plane if it is so near, in spacings, as meshes resolve, and its normal is one of the plane's patch: noise and curvature
// leave as much. From the line on it is beyond what the ends of creases and of walls that stand on others scatter by.
constexpr double kLayer = kFinestCell;
// Each of the four halves has so many points at least: of an X there are twice as many.
constexpr std::size_t kFewestInHalf = kRing / 2;

struct Look {
  std::vector<std::uint32_t> around;
  std::vector<double> squared;
};

// A place on the line where two planes meet, and the points around it.
struct OnLine {
  Vec3 place;
  double spacing;  // of the points there
  const std::vector<std::uint32_t>& around;
};

// One of the two planes.
struct Plane {
  Vec3 normal;
  Vec3 along;  // in it, across the line
};

// Whether the surface in this plane goes on to both sides of the line. A point whose place or normal is nearer to the other plane is of
// that one: creases of little more than the angle of a patch, and rounded ones, have nothing else beyond the line.
bool goes_on(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const OnLine& line, const Plane& plane, const Vec3& other) {
  const double layer = kLayer * line.spacing;
  std::array<std::size_t, 2> count{}, front{};
  for (const std::uint32_t j : line.around) {
    const Vec3 d = vector::subtract(points[j], line.place);
    const double cosine = dot(normals[j], plane.normal), t = dot(d, plane.along), height = std::fabs(dot(d, plane.normal));
    if (height > layer || std::fabs(cosine) < kSameLocalPatch || std::fabs(t) < layer) continue;
    if (std::fabs(dot(d, other)) < height || std::fabs(dot(normals[j], other)) > std::fabs(cosine)) continue;
    const std::size_t half = t > 0 ? 1 : 0;
    ++count[half];
    front[half] += cosine > 0 ? 1 : 0;
  }
  for (std::size_t half = 0; half < 2; ++half) {
    const auto one_sided = static_cast<double>(std::max(front[half], count[half] - front[half]));
    // The sides of a thin wall have normals of both ways.
    if (count[half] < kFewestInHalf || one_sided < kNearlyAll * static_cast<double>(count[half])) return false;
  }
  return true;
}

// The angle in degrees at which surfaces cross near point i, 0 if none do.
double crossing_at(const PointSet& set, const std::vector<Vec3>& normals, std::size_t i, Look& look) {
  const std::vector<Vec3>& points = set.points();
  const std::uint32_t* const near = set.near().data() + i * set.near_count();
  const std::uint32_t* const end = near + set.near_count();
  const Vec3& a = normals[i];
  const auto is_other = [&](std::uint32_t j) { return std::fabs(dot(a, normals[j])) < kSameLocalPatch; };
  if (static_cast<std::size_t>(std::count_if(near, end, is_other)) < kPatchPoints) return 0;  // fewer: noise of normals
  const std::uint32_t other = *std::find_if(near, end, is_other);
  const Vec3& b = normals[other];
  // The line of the planes a.(x - p) = 0 and b.(x - q) = 0, at its place nearest to p: p + t u, where u is in the first plane and across
  // the line, and b.(p + t u - q) = 0.
  const Vec3 line = vector::normalised(vector::cross(a, b));
  const Vec3 u = vector::cross(line, a), v = vector::cross(line, b);
  const double t = dot(b, vector::subtract(points[other], points[i])) / dot(b, u);
  const double spacing = set.smoothed_spacing()[i];
  if (!std::isfinite(t)) return 0;
  const Vec3 place = vector::add(points[i], vector::scale(u, t));
  set.tree().nearest(place, kAround, look.around, look.squared);
  const auto explained = std::count_if(look.around.begin(), look.around.end(), [&](std::uint32_t j) {
    const Vec3 d = vector::subtract(points[j], place);
    return std::min(std::fabs(dot(d, a)), std::fabs(dot(d, b))) < kLayer * spacing;
  });
  // Where shapes are more than two surfaces, fewer are on one of the two planes.
  if (static_cast<double>(explained) < kNearlyAll * static_cast<double>(look.around.size())) return 0;
  const OnLine at{place, spacing, look.around};
  const bool both = goes_on(points, normals, at, {a, u}, b) && goes_on(points, normals, at, {b, v}, a);
  return both ? degrees(std::acos(std::min(1.0, std::fabs(dot(a, b))))) : 0;
}

}  // namespace

Crossings find_crossings(const PointSet& set, const std::vector<Vec3>& normals) {
  // The share from which crossings are clear.
  const double clear = 1 / std::sqrt(static_cast<double>(set.size()));
  // Of so few looks that the share is still known to a tenth of itself: its deviation is 1 / sqrt(clear looks).
  const double looks_needed = 1 / (clear * (1 - kNearlyAll) * (1 - kNearlyAll));
  const auto every = static_cast<std::size_t>(std::max(1.0, static_cast<double>(set.size()) / looks_needed));
  std::vector<double> angles((set.size() + every - 1) / every, 0);
  if (angles.empty()) return {};
  (void)set.tree();  // made before threads ask for them
  (void)set.near();
  (void)set.smoothed_spacing();
  parallel::for_blocks(angles.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    Look look;
    for (std::size_t k = begin; k < end; ++k) angles[k] = crossing_at(set, normals, k * every, look);
  });
  const auto looks = static_cast<double>(angles.size());
  angles.erase(std::remove(angles.begin(), angles.end(), 0.0), angles.end());
  if (angles.empty()) return {};
  Crossings found;
  found.share = static_cast<double>(angles.size()) / looks;
  found.angle = median(angles);
  // Along a curve as long as the side of a square of the same area there is one for each spacing. Of 51 shapes without crossings, 5,000
  // points each, 0.85 times as many at most look so, of crossings three times as many and more.
  found.is_clear = found.share >= clear;
  return found;
}

}  // namespace g3r::mesh
