#include "mesh/mesh_finish.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "g3r/error.h"
#include "median.h"
#include "mesh/mesh_parts.h"
#include "mesh/simplify.h"
#include "mesh/smooth_spacing.h"
#include "vector.h"

namespace g3r::mesh {
namespace {

constexpr double kFarSpacings = 4;     // surface farther from every point than this is a guess
constexpr double kLeastComponent = 8;  // points: smaller ones are specks of the sign
constexpr double kLeastPerNoise = 4;   // squared noise for which one point more is asked: it leaves spheres of 1.7 standard deviations
constexpr int kEarPasses = 2;          // of removing triangles that hang on by one edge, for a smoother boundary

// Distance of each place to the nearest point, in units of `unit(nearest point)`.
template <class Unit>
std::vector<double> distance_to_points(const std::vector<Vec3>& places, const std::vector<Vec3>& points, const Unit& unit) {
  const Neighbours neighbours(points);
  std::vector<double> out(places.size());
  parallel::for_blocks(places.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) {
      neighbours.nearest(places[i], 1, index, squared);
      out[i] = std::sqrt(squared[0]) / unit(index[0]);
    }
  });
  return out;
}

// Triangles joined to the rest by one edge only are cut off too.
void drop_ears(const Mesh& mesh, std::vector<std::uint8_t>& keep) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> edges;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep[t] == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      edges.emplace_back((std::min(a, b) << 32U) | std::max(a, b), t);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint8_t> open(mesh.triangles.size(), 0);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool shared = (i > 0 && edges[i - 1].first == edges[i].first) || (i + 1 < edges.size() && edges[i + 1].first == edges[i].first);
    if (!shared) ++open[edges[i].second];
  }
  for (std::size_t t = 0; t < keep.size(); ++t) {
    if (open[t] >= 2) keep[t] = 0;
  }
}

void trim(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& spacing, const MeshOptions& options) {
  const bool by_distance = options.trim == MeshOptions::Trim::kDistance;
  const std::vector<double> distance = distance_to_points(
      mesh.vertices, points, [&](std::uint32_t i) { return by_distance ? options.trim_distance : kFarSpacings * spacing[i]; });
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const auto& v = mesh.triangles[t];
    keep[t] = distance[v[0]] <= 1 && distance[v[1]] <= 1 && distance[v[2]] <= 1 ? 1 : 0;
  }
  if (std::all_of(keep.begin(), keep.end(), [](std::uint8_t k) { return k != 0; })) return;
  for (int pass = 0; pass < kEarPasses; ++pass) drop_ears(mesh, keep);
  remove_triangles(mesh, keep);
  if (mesh.triangles.empty()) throw InvalidInput("trimming removed the whole mesh: the trim distance is too small");
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
  const bool by_distance = options.trim == MeshOptions::Trim::kDistance;
  if (by_distance && !(options.trim_distance > 0)) throw InvalidInput("the trim distance must be positive");
  const double least = options.min_component.value_or(kLeastComponent);
  if (!(least >= 0)) throw InvalidInput("the smallest component must not be negative");
  if (mesh.triangles.empty()) return;
  if (options.trim != MeshOptions::Trim::kOff) trim(mesh, points, spacing, options);
  const double scatter = options.min_component ? 0 : noise * median(spacing);
  std::optional<Neighbours> neighbours;  // most meshes have one component and do not ask
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  const auto per_point = [&](const Vec3& place) {
    if (!neighbours) neighbours.emplace(points);
    neighbours->nearest(place, 1, index, squared);
    return spacing[index[0]] * spacing[index[0]] + kLeastPerNoise * scatter * scatter;
  };
  remove_components(mesh, least, per_point, options.keep_largest);
  if (options.faces > 0) simplify(mesh, options.faces);
}

}  // namespace g3r::mesh
