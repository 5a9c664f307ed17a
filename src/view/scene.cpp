#include "view/scene.h"

#include <algorithm>
#include <string>

namespace g3r::view {
namespace {

void require_size(std::size_t have, std::size_t points, const char* what) {
  if (have != 0 && have != points) {
    throw InvalidInput(std::string("view: ") + what + " has " + std::to_string(have) + " entries for " + std::to_string(points) +
                       " points");
  }
}

}  // namespace

Box check_scene(const Scene& scene) {
  const std::size_t n = scene.points.size();
  require_size(scene.normals.size(), n, "normals");
  require_size(scene.confidence.size(), n, "confidence");
  require_size(scene.colors.size(), n, "colors");
  require_size(scene.true_normals.size(), n, "true_normals");
  const std::size_t vertices = scene.mesh.vertices.size();
  if (!scene.mesh.colors.empty() && scene.mesh.colors.size() != vertices)
    throw InvalidInput("view: the mesh has fewer colours than vertices");
  if (!scene.mesh.confidence.empty() && scene.mesh.confidence.size() != vertices) {
    throw InvalidInput("view: the mesh has " + std::to_string(scene.mesh.confidence.size()) + " confidences for " +
                       std::to_string(vertices) + " vertices");
  }

  Box box;
  const auto include = [&box](const Vec3& p) {
    if (is_finite(p)) box.extend(p);
  };
  for (const Vec3& p : scene.points) include(p);
  for (const auto& triangle : scene.mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      if (v >= vertices) throw InvalidInput("view: a triangle names vertex " + std::to_string(v) + " of " + std::to_string(vertices));
      include(scene.mesh.vertices[v]);
    }
  }
  if (!(box.low[0] <= box.high[0])) throw InvalidInput("view: nothing to show: no finite point and no triangle");
  return box;
}

double estimate_spacing(const std::vector<Vec3>& points, const Box& box) {
  // A cell of a random plane grid section has about 2/3 of the area of a cell face: mean over directions of the cut area.
  constexpr double kAreaPerCell = 2.0 / 3.0;
  constexpr double kPointsPerCell = 4;  // With fewer points in a cell, empty cells inside the surface would make the count too small.
  constexpr std::size_t kFinest = 512;  // More cells per side would take more than 16 MiB of bits.
  const double side = box.longest_side();
  std::uint64_t count = 0;
  for (const Vec3& p : points) count += is_finite(p) ? 1 : 0;
  if (side <= 0 || count == 0) return 0;

  double spacing = side / std::sqrt(static_cast<double>(count));
  for (std::size_t cells = 2; cells <= kFinest; cells *= 2) {
    std::vector<bool> occupied(cells * cells * cells, false);
    std::size_t occupied_count = 0;
    for (const Vec3& p : points) {
      if (!is_finite(p)) continue;
      std::size_t cell = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double u = (p[k] - box.low[k]) / side * static_cast<double>(cells);
        cell = cell * cells + std::min(static_cast<std::size_t>(u), cells - 1);
      }
      occupied_count += occupied[cell] ? 0 : 1;
      occupied[cell] = true;
    }
    const auto hit = static_cast<double>(occupied_count);
    if (static_cast<double>(count) < kPointsPerCell * hit) break;
    const double cell = side / static_cast<double>(cells);
    spacing = cell * std::sqrt(kAreaPerCell * hit / static_cast<double>(count));
  }
  return spacing;
}

Vec3 unit_or_zero(const Vec3& n) {
  if (!is_finite(n)) return {0, 0, 0};
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 0};
  return {n[0] / length, n[1] / length, n[2] / length};
}

float normal_error(const Vec3& n, const Vec3& t) {
  const Vec3 a = unit_or_zero(n);
  const Vec3 b = unit_or_zero(t);
  return static_cast<float>((1 - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2])) / 2);
}

}  // namespace g3r::view
