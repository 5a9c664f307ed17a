#include "mesh/mesh_finish.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/distance_to_points.h"
#include "mesh/held_points.h"
#include "mesh/mesh_parts.h"
#include "mesh/simplify.h"
#include "mesh/smooth_spacing.h"
#include "mesh/trim.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace g3r::mesh {
namespace {

constexpr double kAtSpacings = 1.5;    // of a point and of noise, from it to the centre of a triangle that it holds
constexpr double kBesideSpacings = 3;  // of a point, up to which a stray is beside it
constexpr std::uint32_t kNothing = 0xffffffff;
constexpr double kAnywhere = 1e150;    // its square is a number still
constexpr double kLeastComponent = 8;  // points: smaller ones are specks of the sign
constexpr double kLeastPerNoise = 4;   // squared noise for which one point more is asked: it leaves spheres of 1.7 standard deviations

// What holds a component.
struct Support {
  double area = 0;        // of its surface
  double near_area = 0;   // of that within kFarSpacings of a point
  double stands_for = 0;  // points that its area stands for
  double strays = 0;      // beside it
  double points = 0;      // that lie at it
};

// For every place the nearest of some points within its reach, or kNothing.
template <class Reach>
std::vector<std::uint32_t> nearest_of(const std::vector<Vec3>& points, const std::vector<Vec3>& places, const Reach& reach) {
  const Neighbours neighbours(points);
  std::vector<std::uint32_t> out(places.size());
  parallel::for_blocks(places.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double squared = std::pow(reach(i), 2);
      out[i] = neighbours.nearest(places[i], squared, kNothing);
    }
  });
  return out;
}

// `scatter`: of the points about the surface; `speck`: the same where noise makes specks of the sign.
std::vector<Support> support_of(const Mesh& mesh, const Components& components, const std::vector<Vec3>& points,
                                const std::vector<double>& spacing, double scatter, double speck, const std::vector<Vec3>& strays) {
  std::vector<Support> support(components.count);
  std::vector<Vec3> centres;
  for (const auto& t : mesh.triangles) {
    const Vec3 sum = vector::add(mesh.vertices[t[0]], vector::add(mesh.vertices[t[1]], mesh.vertices[t[2]]));
    centres.push_back(vector::scale(sum, 1.0 / 3));
  }
  const std::vector<std::uint32_t> nearest = nearest_of(points, centres, [](std::size_t) { return kAnywhere; });
  for (std::size_t t = 0; t < centres.size(); ++t) {
    const double h2 = spacing[nearest[t]] * spacing[nearest[t]];
    const double area = area_of(mesh, mesh.triangles[t]);
    const Vec3 d = vector::subtract(centres[t], points[nearest[t]]);
    Support& of = support[components.of[t]];
    of.area += area;
    of.near_area += vector::dot(d, d) <= kFarSpacings * kFarSpacings * h2 ? area : 0;
    of.stands_for += area / (h2 + kLeastPerNoise * speck * speck);
  }
  const std::vector<std::uint32_t> held_by =
      nearest_of(centres, points, [&](std::size_t i) { return kAtSpacings * (spacing[i] + scatter); });
  for (const std::uint32_t t : held_by) {
    if (t != kNothing) ++support[components.of[t]].points;
  }
  const std::vector<std::uint32_t> beside = nearest_of(points, strays, [](std::size_t) { return kAnywhere; });
  for (std::size_t k = 0; k < strays.size(); ++k) {
    const Vec3 d = vector::subtract(strays[k], points[beside[k]]);
    if (held_by[beside[k]] == kNothing || std::sqrt(vector::dot(d, d)) > kBesideSpacings * spacing[beside[k]]) continue;
    ++support[components.of[held_by[beside[k]]]].strays;
  }
  return support;
}

// Components that too few points hold, and those beyond the largest that are asked for. The largest always stays.
void drop_components(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& spacing, double noise,
                     const MeshOptions& options, LeftOut& left_out) {
  const Components components = find_components(mesh);
  if (components.count < 2) return;
  const double scatter = noise * median(spacing);
  const std::vector<Support> support =
      support_of(mesh, components, points, spacing, scatter, options.min_component ? 0 : scatter, left_out.strays);
  std::vector<std::uint32_t> order(components.count);
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return support[a].near_area > support[b].near_area; });
  const double least_area = options.min_component.value_or(options.keep_all ? 0 : kLeastComponent);
  const bool by_points = !options.min_component && !options.keep_all;
  const double least_points = least_points_of_a_part(left_out.strays.size());
  std::vector<std::uint8_t> keep(components.count, 1);
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Support& of = support[order[k]];
    if (of.stands_for < least_area || (by_points && of.points < std::max(least_points, of.strays))) {
      keep[order[k]] = 0;
      ++left_out.dropped.components;
      left_out.dropped.area += of.area;
    } else if (options.keep_largest > 0 && k >= options.keep_largest) {
      keep[order[k]] = 0;
    }
  }
  remove_components(mesh, components, keep);
}

}  // namespace

double far_share(const Mesh& mesh, const std::vector<Vec3>& points, double spacings) {
  const std::vector<double> spacing = smooth_spacing(points);
  std::vector<Vec3> centres;
  std::vector<double> area;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    centres.push_back({(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3});
    const Vec3 n = vector::cross(vector::subtract(b, a), vector::subtract(c, a));
    area.push_back(std::sqrt(vector::dot(n, n)));
  }
  const std::vector<double> distance = distance_to_points(centres, points, [&](std::uint32_t i) { return spacings * spacing[i]; });
  double far = 0, total = 0;
  for (std::size_t t = 0; t < area.size(); ++t) {
    total += area[t];
    if (distance[t] > 1) far += area[t];
  }
  return total > 0 ? far / total : 0;
}

void finish_mesh(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& spacing, double noise,
                 const MeshOptions& options) {
  LeftOut nothing;
  finish_mesh(mesh, points, spacing, noise, options, nothing);
}

void finish_mesh(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& spacing, double noise, const MeshOptions& options,
                 LeftOut& left_out) {
  const bool by_distance = options.trim == MeshOptions::Trim::kDistance;
  if (by_distance && !(options.trim_distance > 0)) throw InvalidInput("the trim distance must be positive");
  if (!(options.min_component.value_or(0) >= 0)) throw InvalidInput("the smallest component must not be negative");
  if (mesh.triangles.empty()) return;
  if (options.trim != MeshOptions::Trim::kOff) trim(mesh, points, spacing, options);
  drop_components(mesh, points, spacing, noise, options, left_out);
  if (options.faces > 0) simplify(mesh, options.faces);
}

}  // namespace g3r::mesh
