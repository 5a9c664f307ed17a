// view_png(): chooses layers, places four cameras, fills one canvas per tile.
#include "cpu/parallel.h"
#include "view/canvas.h"
#include "view/scene.h"

#include <algorithm>
#include <cmath>
#include <string>

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

constexpr int kViews = 4;  // There are so many views: three-quarter, front, side and top.
// Half of the camera's angle, in radians: with 24 degrees in all, depth is felt and proportions stay true.
constexpr double kHalfAngle = 0.21;
constexpr double kMargin = 1.08;  // The picture is so many times as wide as the object, for a border.
// With this radius in spacings discs just overlap; smaller ones leave holes, larger ones hide shape.
constexpr double kDiscPerSpacing = 0.85;
constexpr double kDotPerSpacing = 0.45;  // With this radius points without normals stay apart.
// Random points leave holes through which the far side would be seen, from its inside: behind every disc lies a larger one, by this factor
// and so many spacings behind, where it does not cut through its neighbours.
constexpr double kFillPerDisc = 2.2;
constexpr double kFillBehind = 1.5;
// The cosine below which a disc is shown as facing away: at the silhouette noise alone turns it, and would make a red rim.
constexpr float kHorizon = -0.2F;
constexpr double kSmoothCosine = 0.8;  // Edges sharper than this cosine, 37 degrees, stay sharp when shaded.

constexpr unsigned kNearGrey = 0x7d838c;
constexpr unsigned kFarGrey = 0xd5d9df;
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

// The points that a layer draws, and the vertices that triangles use.
std::vector<Vector3d> drawn_points(const Scene& scene, bool mesh) {
  std::vector<Vector3d> points;
  if (mesh) {
    std::vector<bool> used(scene.mesh.vertices.size(), false);
    for (const auto& triangle : scene.mesh.triangles) {
      for (const std::uint32_t v : triangle) used[v] = true;
    }
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (used[v] && view::is_finite(scene.mesh.vertices[v])) points.push_back(as_vector(scene.mesh.vertices[v]));
    }
  } else {
    for (const Vec3& p : scene.points) {
      if (view::is_finite(p)) points.push_back(as_vector(p));
    }
  }
  return points;
}

// A camera of the given direction that has all points in sight, and their picture in the middle.
Camera fit_camera(const std::vector<Vector3d>& points, const Eigen::Matrix3d& axes, const Vector3d& centre, double radius) {
  constexpr int kRounds = 4;  // each takes the offset of the picture to a small share of itself
  Camera camera{axes, centre, 1 / radius, 1, kHalfAngle};
  const double tangent = std::tan(kHalfAngle) / kMargin;
  for (int round = 0; round < kRounds; ++round) {
    double distance = 0.5;
    for (const Vector3d& p : points) {
      const Vector3d v = axes * (p - camera.centre) / radius;
      distance = std::max(distance, std::max(std::abs(v.x()), std::abs(v.y())) / tangent + v.z());
    }
    camera.distance = distance;
    if (round + 1 == kRounds) break;
    Eigen::Array2d low = Eigen::Array2d::Constant(1), high = -low;  // tangents of the directions to the points
    for (const Vector3d& p : points) {
      const Vector3d v = axes * (p - camera.centre) / radius;
      const Eigen::Array2d direction = v.head<2>().array() / (distance - v.z());
      low = low.min(direction);
      high = high.max(direction);
    }
    const Eigen::Array2d middle = (low + high) / 2 * distance * radius;
    if (middle.allFinite()) camera.centre += axes.transpose() * Vector3d(middle.x(), middle.y(), 0);
  }
  return camera;
}

// Unit normals of the three corners of every triangle, in world space: the mean, weighted by area, of the normals of those
// triangles at the vertex that make less than a crease with this one.
std::vector<std::array<Vector3f, 3>> corner_normals(const Mesh& mesh) {
  const std::size_t triangles = mesh.triangles.size();
  std::vector<Vector3d> area(triangles);
  std::vector<std::size_t> begin(mesh.vertices.size() + 1, 0);
  for (std::size_t f = 0; f < triangles; ++f) {
    const auto& t = mesh.triangles[f];
    const Vector3d a = as_vector(mesh.vertices[t[0]]);
    area[f] = (as_vector(mesh.vertices[t[1]]) - a).cross(as_vector(mesh.vertices[t[2]]) - a);
    if (!area[f].allFinite()) area[f].setZero();
    for (const std::uint32_t v : t) ++begin[v + 1];
  }
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<std::uint32_t> around(3 * triangles);
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t f = 0; f < triangles; ++f) {
    for (const std::uint32_t v : mesh.triangles[f]) around[next[v]++] = static_cast<std::uint32_t>(f);
  }

  std::vector<std::array<Vector3f, 3>> normals(triangles);
  parallel::for_blocks(triangles, 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) {
      const Vector3d own = area[f].normalized();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.triangles[f][k];
        Vector3d sum = Vector3d::Zero();
        for (std::size_t i = begin[v]; i < begin[v + 1]; ++i) {
          const Vector3d& other = area[around[i]];
          if (other.dot(own) > kSmoothCosine * other.norm()) sum += other;
        }
        normals[f][k] = sum.normalized().cast<float>();
      }
    }
  });
  return normals;
}

void draw_mesh(Canvas& canvas, const Camera& camera, const Mesh& mesh, const std::vector<std::array<Vector3f, 3>>& normals) {
  const Vector3f front = view::linear_rgb(kMeshOutside);
  const Vector3f inside = view::linear_rgb(kInside);
  const Eigen::Matrix3f axes = camera.axes.cast<float>();
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    std::array<Corner, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[f][k];
      corner[k] = {camera.to_view(as_vector(mesh.vertices[v])), axes * normals[f][k],
                   mesh.colors.empty() ? front : byte_color(mesh.colors[v])};
    }
    canvas.draw_triangle(corner[0], corner[1], corner[2], inside);
  }
}

// `height` towards the viewer, -1..1: points without light of their own fade into the distance.
Vector3f disc_color(const Scene& scene, Layer layer, std::size_t i, bool outside, float height) {
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
  const float near = std::clamp((height + 1) / 2, 0.0F, 1.0F);
  return view::linear_rgb(kFarGrey) * (1 - near) + view::linear_rgb(kNearGrey) * near;
}

void draw_points(Canvas& canvas, const Camera& camera, const Scene& scene, Layer layer, double spacing) {
  const bool oriented = !scene.normals.empty() && layer != Layer::kPoints;
  const auto radius = static_cast<float>((oriented ? kDiscPerSpacing : kDotPerSpacing) * spacing * camera.scale);
  const auto fill_radius = static_cast<float>(kFillPerDisc) * radius;
  const auto fill_behind = static_cast<float>(kFillBehind * spacing * camera.scale);
  const Vector3f eye(0, 0, static_cast<float>(camera.distance));
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (!view::is_finite(scene.points[i])) continue;
    const Vector3f p = camera.to_view(as_vector(scene.points[i]));
    Vector3f n = Vector3f::Zero();
    if (oriented) n = (camera.axes * as_vector(view::unit_or_zero(scene.normals[i]))).cast<float>();
    const bool known = n.squaredNorm() > 0;
    const bool missing = layer == Layer::kNormals && !known;
    const Vector3f to_eye = (eye - p).normalized();
    const Vector3f color = missing ? view::linear_rgb(kUnknown) : disc_color(scene, layer, i, n.dot(to_eye) > kHorizon, p.z());
    canvas.draw_disc(p, n, radius, color);
    if (known) canvas.draw_disc(p - fill_behind * to_eye, n, fill_radius, color);
  }
}

// What a layer needs and the scene lacks, "" if it lacks nothing.
std::string lacking(const Scene& scene, Layer layer) {
  if (layer == Layer::kMesh) return scene.mesh.triangles.empty() ? "the layer mesh needs a mesh" : "";
  if (scene.points.empty()) return "all layers but mesh need a cloud";
  const std::string orients = ": `g3r orient` adds ";
  if (layer == Layer::kNormals && scene.normals.empty()) return "the layer normals needs a cloud with normals" + orients + "them";
  if (layer == Layer::kConfidence && scene.confidence.empty()) return "the layer confidence needs a cloud with confidence" + orients + "it";
  if (layer == Layer::kColors && scene.colors.empty()) return "the layer colors needs a cloud with colours";
  if (layer == Layer::kError && scene.normals.empty()) return "the layer error needs a cloud with normals" + orients + "them";
  if (layer == Layer::kError && scene.true_normals.empty()) return "the layer error needs true normals to compare with (--truth)";
  return "";
}

void require_layer(const Scene& scene, Layer layer) {
  const std::string lacks = lacking(scene, layer);
  if (!lacks.empty()) throw InvalidInput("view: " + lacks);
}

Layer best_layer(const Scene& scene) {
  if (!scene.mesh.triangles.empty()) return Layer::kMesh;
  if (!scene.normals.empty()) return Layer::kNormals;
  return scene.colors.empty() ? Layer::kPoints : Layer::kColors;
}

}  // namespace

std::vector<std::uint8_t> view_png(const Scene& scene, const PictureOptions& options) {
  const Box box = view::check_scene(scene);
  if (options.tile < 16 || options.tile > 2048) throw InvalidInput("view: the tile must have 16 to 2048 pixels a side");
  if (options.views < 1 || options.views > kViews) throw InvalidInput("view: there are 1 to 4 views");
  std::vector<Layer> layers = options.layers;
  if (layers.empty()) layers.push_back(best_layer(scene));
  for (const Layer layer : layers) require_layer(scene, layer);

  const double degree = std::acos(-1.0) / 180;
  const std::array<Eigen::Matrix3d, kViews> directions = {axes_from(35 * degree, 22 * degree, options.up), axes_from(0, 0, options.up),
                                                          axes_from(90 * degree, 0, options.up), axes_from(0, 90 * degree, options.up)};
  const Vector3d centre = as_vector(box.centre());
  const double radius = std::max((as_vector(box.high) - as_vector(box.low)).norm() / 2, 1e-30);
  double spacing = view::estimate_spacing(scene.points, box);
  if (spacing <= 0) spacing = 0.02 * radius;
  const auto normals = corner_normals(scene.mesh);
  std::array<std::vector<Vector3d>, 2> drawn;  // by points, by the mesh
  for (const Layer layer : layers) {
    const bool mesh = layer == Layer::kMesh;
    if (drawn[mesh ? 1 : 0].empty()) drawn[mesh ? 1 : 0] = drawn_points(scene, mesh);
  }

  const auto views = static_cast<std::size_t>(options.views);
  const int tiles = static_cast<int>(layers.size() * views);
  const int columns = views == 1 ? tiles : tiles == kViews ? 2 : options.views;
  const int rows = tiles / columns;
  Image image{columns * options.tile, rows * options.tile, {}};
  image.rgb.resize(3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  const auto draw_tile = [&](std::size_t tile) {
    const Layer layer = layers[tile / views];
    const Camera camera = fit_camera(drawn[layer == Layer::kMesh ? 1 : 0], directions[tile % views], centre, radius);
    Canvas canvas(camera, options.tile);
    if (layer == Layer::kMesh) {
      draw_mesh(canvas, camera, scene.mesh, normals);
    } else {
      draw_points(canvas, camera, scene, layer, spacing);
    }
    const int column = static_cast<int>(tile) % columns;
    const int row = static_cast<int>(tile) / columns;
    canvas.resolve(image, column * options.tile, row * options.tile, options.dark);
  };
  parallel::with_threads(options.threads, [&] { parallel::for_each(static_cast<std::size_t>(tiles), draw_tile); });
  return view::encode_png(image);
}

}  // namespace g3r
