#include "mesh/component_support.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/held_points.h"
#include "mesh/mesh_parts.h"
#include "mesh/triangle.h"
#include "mesh/trim.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace g3r::mesh {
namespace {

// For every place the nearest of some points within its squared reach, or kNone.
template <class Reach>
std::vector<std::uint32_t> nearest_of(const std::vector<Vec3>& points, const std::vector<Vec3>& places, const Reach& reach) {
  const Neighbours neighbours(points);
  std::vector<std::uint32_t> out(places.size());
  parallel::for_blocks(places.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double squared = reach(i);
      out[i] = neighbours.nearest(places[i], squared, kNone);
    }
  });
  return out;
}

double anywhere(std::size_t) { return std::numeric_limits<double>::max(); }

// For every point the triangle whose centre is nearest, within so many of its spacings and of the scatter, or kNone.
std::vector<std::uint32_t> triangles_at(const Mesh& mesh, const HoldingPoints& points, double spacings) {
  return nearest_of(centres_of(mesh), points.positions,
                    [&](std::size_t i) { return std::pow(spacings * (points.spacing[i] + points.scatter), 2); });
}

}  // namespace

void Support::add(const Support& other) {
  area += other.area;
  near_area += other.near_area;
  stands_for += other.stands_for;
  stands_for_under_noise += other.stands_for_under_noise;
  strays += other.strays;
  points += other.points;
}

void add_areas(const Mesh& mesh, const std::vector<std::uint32_t>& component, const HoldingPoints& points, std::vector<Support>& support) {
  const std::vector<Vec3> centres = centres_of(mesh);
  const std::vector<std::uint32_t> nearest = nearest_of(points.positions, centres, anywhere);
  const double typical = median(points.spacing);
  const double widened = 2 * points.scatter;  // what points stand for, as noise makes spheres of 1.7 standard deviations
  for (std::size_t t = 0; t < centres.size(); ++t) {
    const double h = points.spacing[nearest[t]], h2 = h * h, reach = kFarSpacings * std::min(h, typical);
    const double area = area_of(mesh, mesh.triangles[t]);
    const Vec3 d = vector::subtract(centres[t], points.positions[nearest[t]]);
    Support& of = support[component[t]];
    of.area += area;
    of.near_area += vector::dot(d, d) <= reach * reach ? area : 0;
    of.stands_for += area / h2;
    of.stands_for_under_noise += area / (h2 + widened * widened);
  }
}

void add_points(const Mesh& mesh, const std::vector<std::uint32_t>& component, const HoldingPoints& points, const std::vector<Vec3>& strays,
                std::vector<Support>& support) {
  const std::vector<std::uint32_t> held_by = triangles_at(mesh, points, kGap);
  for (const std::uint32_t t : held_by) {
    if (t != kNone) ++support[component[t]].points;
  }
  const std::vector<std::uint32_t> beside = nearest_of(points.positions, strays, anywhere);
  for (std::size_t k = 0; k < strays.size(); ++k) {
    const Vec3 d = vector::subtract(strays[k], points.positions[beside[k]]);
    if (held_by[beside[k]] == kNone || std::sqrt(vector::dot(d, d)) > kFarSpacings * points.spacing[beside[k]]) continue;
    ++support[component[held_by[beside[k]]]].strays;
  }
}

Unmet unmet_points(const Mesh& mesh, const HoldingPoints& points, const std::vector<Vec3>& normals) {
  const std::vector<std::uint32_t> held_by = triangles_at(mesh, points, kFarSpacings);
  std::size_t bare = 0, turned = 0;
  for (std::size_t i = 0; i < held_by.size(); ++i) {
    if (held_by[i] == kNone) {
      ++bare;
      continue;
    }
    const Vec3 outward = vector::normalised(twice_area_vector(mesh.vertices, mesh.triangles[held_by[i]]));
    turned += vector::dot(outward, normals[i]) < -kSlant ? 1 : 0;
  }
  const auto all = static_cast<double>(held_by.size());
  return {static_cast<double>(bare) / all, static_cast<double>(turned) / all};
}

std::vector<std::uint8_t> kept_components(const std::vector<Support>& support, const MeshOptions& options, std::size_t strays,
                                          Dropped& dropped) {
  std::vector<std::size_t> order(support.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return support[a].near_area > support[b].near_area; });
  // Components that stand for fewer points are spurious, as signs of single corners make them.
  const double least_area = options.min_component.value_or(options.keep_all ? 0.0 : kRing);
  const bool by_points = !options.min_component && !options.keep_all;
  const double least_points = least_points_of_a_part(strays);
  std::vector<std::uint8_t> keep(support.size(), 1);
  std::size_t kept = 1;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Support& of = support[order[k]];
    const double stands_for = options.min_component ? of.stands_for : of.stands_for_under_noise;
    const bool is_guess = of.near_area == 0 || of.points < std::max(least_points, of.strays);
    if (stands_for < least_area || (by_points && is_guess)) {
      keep[order[k]] = 0;
      ++dropped.components;
      dropped.area += of.area;
    } else if (options.keep_largest > 0 && kept >= options.keep_largest) {
      keep[order[k]] = 0;
    } else {
      ++kept;
    }
  }
  return keep;
}

}  // namespace g3r::mesh
