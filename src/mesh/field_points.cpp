#include "mesh/field_points.h"

#include "base/median.h"
#include "cloud/constants.h"
#include "mesh/constants.h"
#include "mesh/handle_removal.h"
#include "mesh/smooth_spacing.h"

#include <g3r/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace g3r::mesh {
namespace {

// Neighbours kept of each point: the 16 nearest to a place are nearly always among those of its nearest point. With 24 AE_m is 2.9 %
// larger.
constexpr std::size_t kNear = 2 * kFitPoints;
// The levels that locally dense sampling may add: without a bound, points at almost one place would make leaves as small.
constexpr int kMaxSpread = 4;

}  // namespace

void find_neighbours(Prepared& prepared) {
  prepared.neighbours = std::make_unique<Neighbours>(prepared.points.positions);
  prepared.near = prepared.neighbours->of_all(kNear);
}

void prepare(const std::vector<Vec3>& points, std::vector<Vec3> normals, double typical, Prepared& prepared) {
  OrientedPoints& out = prepared.points;
  out = {points, std::move(normals), {}};
  find_neighbours(prepared);
  out.spacing = smooth_spacing(out.positions, prepared.near);
  for (Vec3& n : out.normals) {
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) throw InvalidInput("a normal is zero");
    for (double& c : n) c /= length;
  }
  prepared.typical = typical > 0 ? typical : median(out.spacing);
  if (!(prepared.typical > 0)) throw InvalidInput("all points are at one place");
  // Clusters of almost equal points are no denser for the fits than the octree follows.
  for (double& h : out.spacing) h = std::max(h, prepared.typical / std::exp2(kMaxSpread));
}

double noise_seen(const Noise& noise) { return noise.position > kNoisy ? noise.position : 0; }

void smooth_noise(const Noise& noise, const std::atomic<bool>* cancel, Prepared& prepared) {
  prepared.noise = noise_seen(noise);
  if (prepared.noise == 0) return;
  denoise(prepared.points, *prepared.neighbours, noise, prepared.typical, cancel);
  find_neighbours(prepared);
}

double cell_under(double noise) { return std::max(kFinestCell, smoothing_width(noise) / 2); }

double most_per_handle(double noise, double cell) {
  const double blurred = noise > 0 ? std::max(1.0, smoothing_width(noise) / cell) : 1;
  return std::round(kMostPerHandle * blurred * blurred * blurred);
}

std::vector<double> sizes_to_resolve(const Prepared& prepared, const std::vector<std::uint8_t>& in_lines) {
  std::vector<double> sizes = prepared.points.spacing;
  if (prepared.noise > 0) return sizes;  // which side points are on is not known well enough to tell walls
  const std::vector<double> thickness = wall_thickness(prepared.points, prepared.near);
  const bool has_lines = in_lines.size() > kFitPoints;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (has_lines && in_lines[i] != 0) continue;  // what faces it is most often the same line
    // The diagonals of the sides of leaves are no longer than walls are thick, lest both sides of a wall cross one edge. But no leaves are
    // smaller than half of the others: thin walls cost four times the vertices already.
    sizes[i] = std::min(sizes[i], std::max(thickness[i] / (std::numbers::sqrt2 * kFinestCell), sizes[i] / 2));
  }
  return sizes;
}

RefineDisc disc_around(const Vec3& position, const Vec3& normal, double spacing, double size, const LevelRule& rule) {
  const int spread = static_cast<int>(std::lround(std::log2(rule.typical / size)));
  const int wanted = rule.finest + std::min(spread, rule.deepens ? kMaxSpread : 0);
  return {position, normal, kGap * spacing, kDiscHalf * spacing, std::clamp(wanted, kBaseLevel, kMaxOctreeLevel)};
}

std::vector<Vec3> level_places(const std::vector<Vec3>& points) {
  const std::size_t count = std::min(points.size(), kPlaces);
  std::vector<Vec3> places(count);
  for (std::size_t i = 0; i < count; ++i) places[i] = points[static_cast<std::size_t>(std::uint64_t{i} * points.size() / count)];
  return places;
}

}  // namespace g3r::mesh
