// A thousand random scenes (a hundred under the sanitizers): whatever the shape, the mesh is closed, 2-manifold and oriented outward.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "field_shapes.h"
#include "mesh/field_mesher.h"
#include "mesh_topology.h"
#include "sanitized.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

constexpr int kScenes = kSanitized ? 100 : 1000;
constexpr std::size_t kPoints = 60;  // far too few for most scenes: walls, gaps and folds below the spacing

struct Primitive {
  int kind = 0;  // sphere, box, torus
  Vec3 centre{};
  double size = 0;
  bool carve = false;
};

double distance(const Primitive& q, const Vec3& x) {
  const Vec3 p{x[0] - q.centre[0], x[1] - q.centre[1], x[2] - q.centre[2]};
  if (q.kind == 0) return std::hypot(p[0], p[1], p[2]) - q.size;
  if (q.kind == 1) return std::max({std::abs(p[0]) - q.size, std::abs(p[1]) - 0.6 * q.size, std::abs(p[2]) - 0.3 * q.size});
  return std::hypot(std::hypot(p[0], p[1]) - q.size, p[2]) - 0.3 * q.size;
}

// Unions and differences in a random order, the first a union.
using Scene = std::vector<Primitive>;

Scene random_scene(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Scene scene(2 + rng() % 5);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    Primitive& q = scene[i];
    q.kind = static_cast<int>(rng() % 3);
    for (double& c : q.centre) c = 0.6 * uniform(rng);
    q.size = 0.45 + 0.25 * uniform(rng);
    q.carve = i > 0 && rng() % 3 == 0;
  }
  return scene;
}

double distance(const Scene& scene, const Vec3& x) {
  double d = HUGE_VAL;
  for (const Primitive& q : scene) d = q.carve ? std::max(d, -distance(q, x)) : std::min(d, distance(q, x));
  return d;
}

Vec3 gradient(const Scene& scene, const Vec3& x) {
  constexpr double kStep = 1e-5;
  Vec3 g{};
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 low = x, high = x;
    low[a] -= kStep;
    high[a] += kStep;
    g[a] = (distance(scene, high) - distance(scene, low)) / (2 * kStep);
  }
  return g;
}

// Random places moved onto the surface; those that do not arrive are dropped.
OrientedSample sample(const Scene& scene, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(-1.4, 1.4);
  OrientedSample out;
  for (std::size_t tries = 0; tries < 20 * kPoints && out.points.size() < kPoints; ++tries) {
    Vec3 x{uniform(rng), uniform(rng), uniform(rng)};
    Vec3 g{};
    for (int step = 0; step < 8; ++step) {
      g = gradient(scene, x);
      const double d = distance(scene, x), square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
      if (square < 0.25) break;
      for (std::size_t a = 0; a < 3; ++a) x[a] -= d * g[a] / square;
    }
    if (std::abs(distance(scene, x)) > 1e-6 || std::hypot(g[0], g[1], g[2]) < 0.5) continue;
    out.points.push_back(x);
    out.normals.push_back(g);
  }
  return out;
}

TEST(FieldScenes, AThousandRandomScenesGiveClosedManifoldsOrientedOutward) {
  std::mt19937_64 rng(7);
  MeshOptions options;
  options.min_component = 0;
  int meshed = 0;
  for (int i = 0; i < kScenes; ++i) {
    const Scene scene = random_scene(rng);
    const OrientedSample s = sample(scene, rng);
    if (s.points.size() < kPoints) continue;  // carved away
    const Mesh mesh = field_mesh(s.points, s.normals, DistanceSampler([&](const Vec3& p) { return distance(scene, p); }, 0.1), options);
    const Topology t = topology(mesh);
    EXPECT_EQ(t.bad_edges + t.bad_vertices, 0U) << "scene " << i;
    EXPECT_GT(t.volume, 0) << "scene " << i;
    ++meshed;
  }
  EXPECT_GT(meshed, kScenes * 9 / 10);
}

}  // namespace
