#include "mesh/mesh_finish.h"

#include "base/median.h"
#include "mesh/component_support.h"
#include "mesh/distance_to_points.h"
#include "mesh/lines.h"
#include "mesh/mesh_parts.h"
#include "mesh/smooth_spacing.h"
#include "mesh/trim.h"

#include <g3r/error.h>

namespace g3r::mesh {
namespace {

// Components that too few points hold, and those beyond the largest that are asked for. The largest always stays.
void drop_components(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& spacing, double noise,
                     const MeshOptions& options, Found& found) {
  const Components components = find_components(mesh);
  if (components.count < 2) return;
  const HoldingPoints holding{points, spacing, noise * median(spacing)};
  std::vector<Support> support(components.count);
  add_areas(mesh, components.of, holding, support);
  add_points(mesh, components.of, holding, found.strays, support);
  const std::vector<std::uint8_t> keep = kept_components(support, options, found.strays.size(), found.dropped);
  double area = 0, pointless = 0;
  for (std::size_t c = 0; c < support.size(); ++c) {
    if (keep[c] == 0) continue;
    area += support[c].area;
    if (support[c].points == 0) pointless += support[c].area;
  }
  found.pointless_area = area > 0 ? pointless / area : 0;
  remove_components(mesh, components, keep);
}

}  // namespace

double far_share(const Mesh& mesh, const std::vector<Vec3>& points, double spacings) {
  const std::vector<double> along = smooth_spacing(points);
  const auto share = [&](const std::vector<double>& spacing) {
    const std::vector<double> distance =
        distance_to_points(centres_of(mesh), points, [&](std::uint32_t i) { return spacings * spacing[i]; });
    double far = 0, total = 0;
    for (std::size_t t = 0; t < distance.size(); ++t) {
      const double area = area_of(mesh, mesh.triangles[t]);
      total += area;
      if (distance[t] > 1) far += area;
    }
    return total > 0 ? far / total : 0;
  };
  return share(along) > 0 ? share(spacing_across_lines(points, along)) : 0;
}

void finish_mesh(Mesh& mesh, const OrientedPoints& points, double noise, const MeshOptions& options, Found& found,
                 const std::atomic<bool>* cancel) {
  const bool by_distance = options.trim == MeshOptions::Trim::kDistance;
  if (by_distance && !(options.trim_distance > 0)) throw InvalidInput("the trim distance must be positive");
  if (!(options.min_component.value_or(0) >= 0)) throw InvalidInput("the smallest component must not be negative");
  if (mesh.triangles.empty()) return;
  if (options.trim != MeshOptions::Trim::kOff) found.trimmed = trim(mesh, points, options, cancel);
  drop_components(mesh, points.positions, points.spacing, noise, options, found);
}

}  // namespace g3r::mesh
