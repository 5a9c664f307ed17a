#include "mesh_run.h"

#include "base/vector.h"
#include "field/surface_points.h"
#include "field/winding_sampler.h"
#include "mesh/constants.h"
#include "mesh/field_mesher.h"
#include "mesh/field_octree.h"
#include "mesh/screened_poisson.h"
#include "mesh/self_intersections.h"
#include "mesh/separate_vertices.h"
#include "mesh/simplify.h"
#include "mesh/smooth_spacing.h"
#include "orient/settings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace g3r {
namespace {

void turn(std::vector<Vec3>& vectors) {
  for (Vec3& v : vectors) v = {-v[0], -v[1], -v[2]};
}

// Brings the strays to the unit frame, whatever the order of the input and however often it has them, and takes out more points that no
// surface goes through.
void take_out_strays(const MeshOptions& options, const Monitor& monitor, OrientedCloud& oriented, mesh::Found& found) {
  for (Vec3& p : found.strays) p = oriented.cloud.frame.to_unit(p);
  std::sort(found.strays.begin(), found.strays.end());
  found.strays.erase(std::unique(found.strays.begin(), found.strays.end()), found.strays.end());
  if (!options.keep_all) keep_surface_points(oriented, found.strays, monitor.cancel);
  found.dropped.points = found.strays.size();
}

Mesh mesh_with_poisson(const OrientedCloud& oriented, MeshOptions options, const Monitor& monitor, mesh::Found& found) {
  const std::vector<Vec3>& points = oriented.cloud.points();
  const std::vector<Vec3> directions = directions_of(oriented.eta);
  const int depth = options.depth > 0 ? options.depth : automatic_depth(oriented.spacing, kBoxSide);
  Mesh mesh = screened_poisson(points, directions, depth);
  options.min_component = 0;  // spurious components of screened Poisson are part of its result
  mesh::finish_mesh(mesh, {points, directions, mesh::smooth_spacing(points)}, 0, options, found, monitor.cancel);
  return mesh;
}

// `options`: with lengths in the unit frame.
Mesh mesh_in_frame(OrientedCloud& oriented, const WindingSampler& field, const MeshOptions& options, const Monitor& monitor, MeshRun& run) {
  if (options.mesher == Mesher::kPoisson) return mesh_with_poisson(oriented, options, monitor, run.found);
  std::vector<Vec3> directions = directions_of(oriented.eta);
  oriented.cloud.set.release_neighbours();  // the mesher has its own, of the points that it moves
  return field_mesh(oriented.cloud.points(), std::move(directions), field, options, monitor, &run.memory, &run.found);
}

void require_surface(const Mesh& mesh, const MeshRun& run, const MeshOptions& options) {
  if (!mesh.triangles.empty()) return;
  throw InvalidInput(is_too_wide(run.box_side, run.spacing, options)
                         ? "no surface found: the cloud is more than 800,000 spacings wide; mesh parts that are far apart one by one"
                         : "no surface found: the oriented points do not enclose a volume");
}

bool asks_for_all(const MeshOptions& options) {
  return options.trim == MeshOptions::Trim::kOff && options.depth == 0 && options.keep_largest == 0 && !options.min_component;
}

// Surface without points, and points without surface.
void find_unmet(const Mesh& mesh, const OrientedCloud& oriented, const MeshOptions& options, MeshRun& run) {
  const std::vector<Vec3>& points = oriented.cloud.points();
  run.far_share = mesh::far_share(mesh, points, mesh::kFarSpacings);
  if (!asks_for_all(options)) return;
  const std::vector<double> spacing = mesh::smooth_spacing(points);
  run.unmet = mesh::unmet_points(mesh, {points, spacing, run.found.noise}, directions_of(oriented.eta));
}

// Returns how many more pairs of triangles intersect than before.
std::size_t simplify_and_count(Mesh& mesh, std::size_t faces, const Monitor& monitor) {
  if (faces == 0 || mesh.triangles.size() <= faces) return 0;
  const std::size_t crossings = mesh::self_intersections(mesh, monitor.cancel).size();
  mesh::simplify(mesh, faces, monitor.cancel);
  const std::size_t left = mesh::self_intersections(mesh, monitor.cancel).size();
  return left > crossings ? left - crossings : 0;
}

void to_world(const Frame& frame, Mesh& mesh) {
  for (Vec3& v : mesh.vertices) {
    for (std::size_t a = 0; a < 3; ++a) v[a] = v[a] / frame.scale + frame.centre[a];
  }
}

}  // namespace

bool is_too_wide(double box_side, double spacing, const MeshOptions& options) {
  return options.mesher == Mesher::kField && options.depth == 0 &&
         box_side > std::ldexp(mesh::kFinestCell, mesh::kMaxOctreeLevel) * spacing;
}

Mesh make_mesh(OrientedCloud oriented, const MeshOptions& options, const Monitor& monitor, MeshRun& run) {
  take_out_strays(options, monitor, oriented, run.found);
  const WindingSampler field(oriented, monitor.cancel);
  const bool inside_out = is_inside_out(oriented, field);
  if (inside_out) turn(oriented.eta);
  const Frame& frame = oriented.cloud.frame;
  MeshOptions normalised = options;
  normalised.trim_distance *= frame.scale;
  const std::optional<double> noise = given_noise(options.noise, oriented.cloud, oriented.spacing);
  if (noise) normalised.noise = {Length::Unit::kInput, *noise};
  Mesh mesh = mesh_in_frame(oriented, field, normalised, monitor, run);
  run.found.dropped.area /= frame.scale * frame.scale;
  run.box_centre = frame.centre;
  run.box_side = frame.length_to_world(kBoxSide);
  run.spacing = frame.length_to_world(oriented.spacing);
  run.noise = frame.length_to_world(noise.value_or(run.found.noise));
  require_surface(mesh, run, options);
  find_unmet(mesh, oriented, options, run);
  run.new_crossings = simplify_and_count(mesh, options.faces, monitor);
  if (inside_out) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  to_world(frame, mesh);
  mesh::separate_vertices(mesh);
  return mesh;
}

}  // namespace g3r
