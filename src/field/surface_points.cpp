#include "field/surface_points.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/morton.h"
#include "mesh/held_points.h"
#include "mesh/point_parts.h"
#include "mesh/regained_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace g3r {
namespace {

// Leaves out the points that are not held.
void leave_out(OrientedCloud& oriented, const std::vector<std::uint8_t>& held, std::vector<Vec3>& strays) {
  if (std::find(held.begin(), held.end(), std::uint8_t{0}) == held.end()) return;
  CanonicalCloud& cloud = oriented.cloud;
  std::vector<Vec3> points;
  points.reserve(held.size());
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0) {
      strays.push_back(cloud.points()[i]);
      continue;
    }
    oriented.eta[points.size()] = oriented.eta[i];
    points.push_back(cloud.points()[i]);
  }
  oriented.eta.resize(points.size());
  cloud.set = PointSet(std::move(points));
}

// Takes points back that the surface goes through. Areas follow the spacing.
void regain_points(OrientedCloud& oriented, std::vector<Vec3>& strays, const std::atomic<bool>* cancel) {
  CanonicalCloud& cloud = oriented.cloud;
  const std::vector<Vec3> normals = mesh::normals_of_regained(cloud.points(), directions_of(oriented.eta), strays, cancel);
  std::vector<Vec3> points = cloud.points(), left;
  std::vector<double> density;  // area over squared spacing
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& eta = oriented.eta[i];
    const double h = cloud.set.smoothed_spacing()[i];
    density.push_back(std::sqrt(vector::dot(eta, eta)) / (h * h));
  }
  const double usual = median(density);
  std::vector<Vec3> directions = directions_of(oriented.eta);
  for (std::size_t k = 0; k < strays.size(); ++k) {
    if (normals[k] == Vec3{0, 0, 0}) {
      left.push_back(strays[k]);
      continue;
    }
    points.push_back(strays[k]);
    directions.push_back(normals[k]);
    density.push_back(usual);
  }
  if (left.size() == strays.size()) return;
  strays = std::move(left);
  const std::vector<std::uint32_t> order = morton_order(points);
  std::vector<Vec3> sorted, sorted_directions;
  std::vector<double> sorted_density;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::uint32_t i = order[k];
    if (!sorted.empty() && sorted.back() == points[i]) continue;  // two may be one in this frame
    sorted.push_back(points[i]);
    sorted_directions.push_back(directions[i]);
    sorted_density.push_back(density[i]);
  }
  cloud.set = PointSet(std::move(sorted));
  oriented.eta.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double h = cloud.set.smoothed_spacing()[i];
    oriented.eta[i] = vector::scale(sorted_directions[i], sorted_density[i] * h * h);
  }
}

// A frame of its own for what is left where strays made the old one much larger, which may not resolve its spacing. Areas follow the
// spacing.
void fit_frame(OrientedCloud& oriented, std::vector<Vec3>& strays) {
  if (!is_small_in_frame(oriented.cloud)) return;
  const Frame old = oriented.cloud.frame;
  const std::vector<double> old_spacing = oriented.cloud.set.smoothed_spacing();
  std::vector<Vec3> points = oriented.cloud.points();
  for (Vec3& p : points) p = old.to_world(p);
  CanonicalCloud cloud = canonical_cloud(PointsView(points));
  std::vector<Vec3> eta(cloud.size(), Vec3{0, 0, 0});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t k = cloud.point_of[i];
    const double growth = cloud.set.smoothed_spacing()[k] / old_spacing[i];
    eta[k] = vector::add(eta[k], vector::scale(oriented.eta[i], growth * growth));
  }
  for (Vec3& p : strays) p = cloud.frame.to_unit(old.to_world(p));
  oriented.cloud = std::move(cloud);
  oriented.eta = std::move(eta);
}

}  // namespace

std::vector<Vec3> directions_of(const std::vector<Vec3>& eta) {
  std::vector<Vec3> directions(eta.size());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    directions[i] = eta[i] == Vec3{0, 0, 0} ? Vec3{0, 0, 1} : vector::normalised(eta[i]);
  }
  return directions;
}

void keep_surface_points(OrientedCloud& oriented, std::vector<Vec3>& strays, const std::atomic<bool>* cancel) {
  std::vector<Vec3> doubtful;
  leave_out(oriented, mesh::held_points(oriented.cloud.points(), directions_of(oriented.eta), cancel), doubtful);
  regain_points(oriented, strays, cancel);
  strays.insert(strays.end(), doubtful.begin(), doubtful.end());
  leave_out(oriented, mesh::points_of_parts(oriented.cloud.set, strays), strays);
  fit_frame(oriented, strays);
  oriented.spacing = oriented.cloud.set.spacing();
}

}  // namespace g3r
