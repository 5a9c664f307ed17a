#include "mesh/trim.h"

#include "base/median.h"
#include "base/vector.h"
#include "mesh/constants.h"
#include "mesh/distance_to_points.h"
#include "mesh/lines.h"
#include "mesh/mesh_parts.h"
#include "mesh/smooth_rims.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace g3r::mesh {
namespace {

// The spacings that a rim may reach beyond its points: one gap in a hundred of a random sample is wider. Where points lie in lines the gaps
// are those between the lines.
constexpr double kRim = 1.2;

using Triangle = std::array<std::uint32_t, 3>;

Vec3 centre_of(const Mesh& mesh, const Triangle& t) {
  return vector::scale(vector::add(mesh.vertices[t[0]], vector::add(mesh.vertices[t[1]], mesh.vertices[t[2]])), 1.0 / 3);
}

// How far from each point surface may be, in its own units. Farther than four spacings of the cloud nobody measured anything; where it is
// sparse, but a surface, the gaps between its points are no holes.
std::vector<double> limits_of(const std::vector<double>& spacing, const MeshOptions& options) {
  if (options.trim == MeshOptions::Trim::kDistance) return std::vector<double>(spacing.size(), options.trim_distance);
  const double typical = median(spacing);
  std::vector<double> limits(spacing.size());
  for (std::size_t i = 0; i < limits.size(); ++i) limits[i] = std::max(kFarSpacings * std::min(spacing[i], typical), kGap * spacing[i]);
  return limits;
}

double longest_side(const std::array<Vec3, 3>& corner) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = vector::subtract(corner[(k + 1) % 3], corner[k]);
    longest = std::max(longest, std::sqrt(vector::dot(side, side)));
  }
  return longest;
}

// Which triangles are within the limits. Corners tell of small ones; of large ones the middles of the sides and the centre are asked as
// well.
std::vector<std::uint8_t> within(const Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& limits) {
  const auto limit = [&](std::uint32_t i) { return limits[i]; };
  std::vector<double> distance = distance_to_points(mesh.vertices, points, limit);
  // No place of a smaller triangle is much farther from a point than its corners.
  const double small = 0.5 * *std::min_element(limits.begin(), limits.end());
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  std::vector<Vec3> places;
  std::vector<std::uint32_t> asker;
  for (std::uint32_t t = 0; t < keep.size(); ++t) {
    const Triangle& v = mesh.triangles[t];
    keep[t] = distance[v[0]] <= 1 && distance[v[1]] <= 1 && distance[v[2]] <= 1 ? 1 : 0;
    const std::array<Vec3, 3> corner{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
    if (keep[t] == 0 || longest_side(corner) <= small) continue;
    for (std::size_t k = 0; k < 3; ++k) places.push_back(vector::scale(vector::add(corner[k], corner[(k + 1) % 3]), 0.5));
    places.push_back(centre_of(mesh, v));
    asker.insert(asker.end(), 4, t);
  }
  distance = distance_to_points(places, points, limit);
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (distance[k] > 1) keep[asker[k]] = 0;
  }
  return keep;
}

// For every triangle those across its three sides: kNone where there is none. A side of more than two triangles has none.
std::vector<Triangle> neighbours_of(const Mesh& mesh) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sides;  // vertices, 3 t + k
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint64_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      sides.emplace_back((std::min(a, b) << 32U) | std::max(a, b), 3 * t + k);
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<Triangle> across(mesh.triangles.size(), Triangle{kNone, kNone, kNone});
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const bool pair = sides[i].first == sides[i + 1].first && (i + 2 == sides.size() || sides[i + 2].first != sides[i].first) &&
                      (i == 0 || sides[i - 1].first != sides[i].first);
    if (!pair) continue;
    const std::uint32_t a = sides[i].second, b = sides[i + 1].second;
    across[a / 3][a % 3] = b / 3;
    across[b / 3][b % 3] = a / 3;
  }
  return across;
}

// From the rims inwards, as far as no point is near.
void draw_in(const Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& spacing, const std::vector<Triangle>& across,
             std::vector<std::uint8_t>& keep) {
  std::vector<Vec3> centres;
  centres.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) centres.push_back(centre_of(mesh, t));
  const std::vector<double> distance = distance_to_points(centres, points, [&](std::uint32_t i) { return kRim * spacing[i]; });
  std::vector<std::uint32_t> gone;
  for (std::uint32_t t = 0; t < keep.size(); ++t) {
    if (keep[t] == 0) gone.push_back(t);
  }
  while (!gone.empty()) {
    const std::uint32_t t = gone.back();
    gone.pop_back();
    for (const std::uint32_t other : across[t]) {
      if (other == kNone || keep[other] == 0 || distance[other] <= 1) continue;
      keep[other] = 0;
      gone.push_back(other);
    }
  }
}

// Triangles joined to the rest by one edge only are cut off.
void drop_ears(const std::vector<Triangle>& across, std::vector<std::uint8_t>& keep) {
  std::vector<std::uint32_t> ears;
  for (std::uint32_t t = 0; t < keep.size(); ++t) {
    const auto joined = std::count_if(across[t].begin(), across[t].end(), [&](std::uint32_t o) { return o != kNone && keep[o] != 0; });
    if (keep[t] != 0 && joined < 2) ears.push_back(t);
  }
  for (const std::uint32_t t : ears) keep[t] = 0;
}

}  // namespace

void trim(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& spacing, const MeshOptions& options) {
  const std::vector<double> limits = limits_of(spacing, options);
  std::vector<std::uint8_t> keep = within(mesh, points, limits);
  if (std::all_of(keep.begin(), keep.end(), [](std::uint8_t k) { return k != 0; })) return;
  const std::vector<Triangle> across = neighbours_of(mesh);
  if (options.trim == MeshOptions::Trim::kAuto) draw_in(mesh, points, spacing_across_lines(points, spacing), across, keep);
  for (int pass = 0; pass < 2; ++pass) drop_ears(across, keep);  // of those that are left, the second time
  remove_triangles(mesh, keep);
  if (mesh.triangles.empty()) throw InvalidInput("trimming removed the whole mesh: the trim distance is too small");
  smooth_rims(mesh, [&](const std::vector<Vec3>& places) {
    std::vector<std::uint8_t> near(places.size());
    const std::vector<double> distance = distance_to_points(places, points, [&](std::uint32_t i) { return limits[i]; });
    std::transform(distance.begin(), distance.end(), near.begin(), [](double d) { return d <= 1 ? 1 : 0; });
    return near;
  });
}

}  // namespace g3r::mesh
