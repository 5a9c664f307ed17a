// view_png(): chooses layers, places four cameras, fills one canvas per tile.
#include "cpu/parallel.h"
#include "view/canvas.h"
#include "view/scene.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace g3r {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using view::Box;
using view::Camera;
using view::Canvas;
using view::Corner;
using view::Image;

constexpr int kViews = 4;
constexpr double kHalfAngle = 0.21;       // 24 degrees in all: depth is felt, proportions stay true
constexpr double kMargin = 1.08;          // empty border around the object
constexpr double kDiscPerSpacing = 0.85;  // discs just overlap
constexpr float kSmoothCosine = 0.7F;     // sharper edges than this (45 degrees) stay sharp when shaded

constexpr unsigned kGrey = 0xb4b9c1;
constexpr unsigned kOutside = 0x4f86d9;
constexpr unsigned kInside = 0xe0483e;
constexpr unsigned kMeshOutside = 0xa9bdd8;
constexpr unsigned kUnknown = 0xd9b43c;  // a point without a normal

// Colour maps as five equidistant sRGB stops: viridis, and grey to red.
constexpr std::array<unsigned, 5> kConfidenceStops = {0x440154, 0x3b528b, 0x21918c, 0x5ec962, 0xfde725};
constexpr std::array<unsigned, 5> kErrorStops = {0xc9ced6, 0xf2c14e, 0xee8434, 0xd1382f, 0x7d0f1f};

Vector3f map_color(const std::array<unsigned, 5>& stops, float value) {
  const float t = 4 * (std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 0.0F);
  const auto i = std::min<std::size_t>(3, static_cast<std::size_t>(t));
  const float f = t - static_cast<float>(i);
  return view::linear_rgb(stops[i]) * (1 - f) + view::linear_rgb(stops[i + 1]) * f;
}

Vector3f byte_color(const std::array<std::uint8_t, 3>& c) {
  return view::linear_rgb((unsigned{c[0]} << 16U) | (unsigned{c[1]} << 8U) | c[2]);
}

Vector3d as_vector(const Vec3& p) { return {p[0], p[1], p[2]}; }

// Rows right, up, back for a viewer at `azimuth` (0: front, 90 degrees: right side) and `elevation`, radians.
Eigen::Matrix3d axes_from(double azimuth, double elevation, Up up) {
  const Vector3d back(std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation));
  const Vector3d right(std::cos(azimuth), 0, -std::sin(azimuth));
  Eigen::Matrix3d axes;
  axes.row(0) = right;
  axes.row(1) = back.cross(right);
  axes.row(2) = back;
  if (up == Up::kZ) {
    Eigen::Matrix3d z_to_y;
    z_to_y << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    axes = axes * z_to_y;
  }
  return axes;
}

// A camera of the given direction that has every point of the layer in sight.
Camera fit_camera(const Scene& scene, bool mesh, const Eigen::Matrix3d& axes, const Vector3d& centre, double radius) {
  Camera camera{axes, centre, 1 / radius, 1, kHalfAngle};
  const double tangent = std::tan(kHalfAngle) / kMargin;
  const auto include = [&](const Vec3& p) {
    if (!view::is_finite(p)) return;
    const Vector3d v = axes * (as_vector(p) - centre) / radius;
    camera.distance = std::max(camera.distance, std::max(std::abs(v.x()), std::abs(v.y())) / tangent + v.z());
  };
  if (mesh) {
    for (const auto& triangle : scene.mesh.triangles) {
      for (const std::uint32_t v : triangle) include(scene.mesh.vertices[v]);
    }
  } else {
    for (const Vec3& p : scene.points) include(p);
  }
  return camera;
}

// Normals of the vertices in world space, weighted by area.
std::vector<Vector3d> vertex_normals(const Mesh& mesh) {
  std::vector<Vector3d> normals(mesh.vertices.size(), Vector3d::Zero());
  for (const auto& t : mesh.triangles) {
    const Vector3d a = as_vector(mesh.vertices[t[0]]);
    const Vector3d n = (as_vector(mesh.vertices[t[1]]) - a).cross(as_vector(mesh.vertices[t[2]]) - a);
    if (!n.allFinite()) continue;
    for (const std::uint32_t v : t) normals[v] += n;
  }
  for (Vector3d& n : normals) n.normalize();
  return normals;
}

void draw_mesh(Canvas& canvas, const Camera& camera, const Mesh& mesh, const std::vector<Vector3d>& normals) {
  const Vector3f front = view::linear_rgb(kMeshOutside);
  const Vector3f inside = view::linear_rgb(kInside);
  const Eigen::Matrix3f axes = camera.axes.cast<float>();
  for (const auto& t : mesh.triangles) {
    std::array<Corner, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k].position = camera.to_view(as_vector(mesh.vertices[t[k]]));
    const Vector3f flat = (corner[1].position - corner[0].position).cross(corner[2].position - corner[0].position).normalized();
    if (!flat.allFinite()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3f smooth = axes * normals[t[k]].cast<float>();
      corner[k].normal = smooth.dot(flat) > kSmoothCosine ? smooth : flat;
      corner[k].color = mesh.colors.empty() ? front : byte_color(mesh.colors[t[k]]);
    }
    canvas.draw_triangle(corner[0], corner[1], corner[2], inside);
  }
}

Vector3f disc_color(const Scene& scene, Layer layer, std::size_t i, bool outside) {
  switch (layer) {
    case Layer::kNormals:
      return view::linear_rgb(outside ? kOutside : kInside);
    case Layer::kConfidence:
      return map_color(kConfidenceStops, scene.confidence[i]);
    case Layer::kColors:
      return byte_color(scene.colors[i]);
    case Layer::kError:
      return map_color(kErrorStops, view::normal_error(scene.normals[i], scene.true_normals[i]));
    case Layer::kPoints:
    case Layer::kMesh:
      break;
  }
  return view::linear_rgb(kGrey);
}

void draw_points(Canvas& canvas, const Camera& camera, const Scene& scene, Layer layer, float radius) {
  const bool oriented = !scene.normals.empty() && layer != Layer::kPoints;
  const Vector3f eye(0, 0, static_cast<float>(camera.distance));
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (!view::is_finite(scene.points[i])) continue;
    const Vector3f p = camera.to_view(as_vector(scene.points[i]));
    Vector3f n = Vector3f::Zero();
    if (oriented) n = (camera.axes * as_vector(view::unit_or_zero(scene.normals[i]))).cast<float>();
    const bool known = n.squaredNorm() > 0;
    const bool missing = layer == Layer::kNormals && !known;
    canvas.draw_disc(p, n, radius, missing ? view::linear_rgb(kUnknown) : disc_color(scene, layer, i, n.dot(eye - p) > 0));
  }
}

void require_layer(const Scene& scene, Layer layer) {
  const bool points = !scene.points.empty();
  bool have = points;
  if (layer == Layer::kMesh) have = !scene.mesh.triangles.empty();
  if (layer == Layer::kNormals) have = points && !scene.normals.empty();
  if (layer == Layer::kConfidence) have = points && !scene.confidence.empty();
  if (layer == Layer::kColors) have = points && !scene.colors.empty();
  if (layer == Layer::kError) have = points && !scene.normals.empty() && !scene.true_normals.empty();
  if (!have) throw InvalidInput("view: a layer was asked for that the scene has no data for");
}

Layer best_layer(const Scene& scene) {
  if (!scene.mesh.triangles.empty()) return Layer::kMesh;
  if (!scene.normals.empty()) return Layer::kNormals;
  return scene.colors.empty() ? Layer::kPoints : Layer::kColors;
}

}  // namespace

std::vector<std::uint8_t> view_png(const Scene& scene, const PictureOptions& options) {
  const Box box = view::check_scene(scene);
  if (options.tile < 16 || options.tile > 4096) throw InvalidInput("view: the tile must have 16 to 4096 pixels a side");
  std::vector<Layer> layers = options.layers;
  if (layers.empty()) layers.push_back(best_layer(scene));
  for (const Layer layer : layers) require_layer(scene, layer);

  const double degree = std::acos(-1.0) / 180;
  const std::array<Eigen::Matrix3d, kViews> directions = {axes_from(35 * degree, 22 * degree, options.up), axes_from(0, 0, options.up),
                                                          axes_from(90 * degree, 0, options.up), axes_from(0, 90 * degree, options.up)};
  const Vector3d centre = as_vector(box.centre());
  const double radius = std::max((as_vector(box.high) - as_vector(box.low)).norm() / 2, 1e-30);
  const double spacing = view::estimate_spacing(scene.points, box);
  const auto disc = static_cast<float>(spacing > 0 ? kDiscPerSpacing * spacing / radius : 0.02);
  const std::vector<Vector3d> normals = vertex_normals(scene.mesh);

  const int rows = layers.size() == 1 ? 2 : static_cast<int>(layers.size());
  const int columns = layers.size() == 1 ? 2 : kViews;
  Image image{columns * options.tile, rows * options.tile, {}};
  image.rgb.resize(3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  parallel::for_each(static_cast<std::size_t>(rows * columns), [&](std::size_t tile) {
    const Layer layer = layers[tile / kViews];
    const Camera camera = fit_camera(scene, layer == Layer::kMesh, directions[tile % kViews], centre, radius);
    Canvas canvas(camera, options.tile);
    if (layer == Layer::kMesh) {
      draw_mesh(canvas, camera, scene.mesh, normals);
    } else {
      draw_points(canvas, camera, scene, layer, disc);
    }
    const int column = static_cast<int>(tile) % columns;
    const int row = static_cast<int>(tile) / columns;
    canvas.resolve(image, column * options.tile, row * options.tile, options.dark);
  });
  return view::encode_png(image);
}

}  // namespace g3r
