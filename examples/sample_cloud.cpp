// sample_cloud OUT [COUNT]: writes points on the surface of a cup on a saucer, without normals.
//
// The cup has thin curved walls, a round handle and an open bowl; the saucer is a thin disc with a raised rim. Together they are one
// closed surface with sharp and smooth parts, the kind of cloud that is hard to orient. The same COUNT gives the same bytes everywhere.
//
// How: the solid is built from spheres, cylinders and tori by union and difference. Points are drawn on the surface of every building
// block with the same density; a point belongs to the surface of the solid when one side of it is inside and the other outside.
#include <g3r/io.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace {

using g3r::Vec3;
using std::numbers::pi;

constexpr std::size_t kDefaultCount = 50'000;
constexpr std::size_t kMaxCount = 100'000'000;
constexpr double kStep = 1e-6;  // from a surface point to either side; the shape has size 2

/// Numbers in [0, 1), the same on every platform.
class Random {
 public:
  double operator()() { return static_cast<double>(generator_() >> 11U) * 0x1p-53; }

 private:
  std::mt19937_64 generator_{1};
};

struct SurfacePoint {
  Vec3 position;
  Vec3 normal;
};

/// A building block: who is inside, how large its surface is, and a random point on it.
struct Block {
  std::function<bool(const Vec3&)> inside;
  double area;
  std::function<SurfacePoint(Random&)> sample;
};

Block sphere(const Vec3& c, double r) {
  return {[=](const Vec3& p) { return std::hypot(p[0] - c[0], p[1] - c[1], p[2] - c[2]) < r; }, 4 * pi * r * r,
          [=](Random& random) {
            const double z = 2 * random() - 1, angle = 2 * pi * random(), ring = std::sqrt(1 - z * z);
            const Vec3 n = {ring * std::cos(angle), ring * std::sin(angle), z};
            return SurfacePoint{{c[0] + r * n[0], c[1] + r * n[1], c[2] + r * n[2]}, n};
          }};
}

/// A cylinder around the z axis from `bottom` to `top`.
Block cylinder(double r, double bottom, double top) {
  const double side = 2 * pi * r * (top - bottom), cap = pi * r * r;
  return {[=](const Vec3& p) { return std::hypot(p[0], p[1]) < r && p[2] > bottom && p[2] < top; }, side + 2 * cap,
          [=](Random& random) {
            const double angle = 2 * pi * random(), part = random() * (side + 2 * cap), along = random();
            const double x = std::cos(angle), y = std::sin(angle);
            if (part < side) return SurfacePoint{{r * x, r * y, bottom + along * (top - bottom)}, {x, y, 0}};
            const double distance = r * std::sqrt(along);
            const bool is_top = part < side + cap;
            return SurfacePoint{{distance * x, distance * y, is_top ? top : bottom}, {0, 0, is_top ? 1.0 : -1.0}};
          }};
}

/// A torus with centre c, ring radius R and tube radius r, its axis along coordinate `axis`.
Block torus(const Vec3& c, double R, double r, std::size_t axis) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  return {[=](const Vec3& p) { return std::hypot(std::hypot(p[u] - c[u], p[v] - c[v]) - R, p[axis] - c[axis]) < r; }, 4 * pi * pi * R * r,
          [=](Random& random) {
            const double ring = 2 * pi * random();
            double tube = 2 * pi * random();
            while (random() * (R + r) > R + r * std::cos(tube)) tube = 2 * pi * random();  // the outside of the ring is longer
            const double outward = std::cos(tube), radius = R + r * outward;
            SurfacePoint s;
            s.position[u] = c[u] + radius * std::cos(ring);
            s.position[v] = c[v] + radius * std::sin(ring);
            s.position[axis] = c[axis] + r * std::sin(tube);
            s.normal[u] = outward * std::cos(ring);
            s.normal[v] = outward * std::sin(ring);
            s.normal[axis] = std::sin(tube);
            return s;
          }};
}

/// The solid: some blocks added, some taken away from what was added before them.
struct Solid {
  std::vector<Block> blocks;
  std::vector<bool> added;

  [[nodiscard]] bool inside(const Vec3& p) const {
    bool result = false;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (blocks[i].inside(p)) result = added[i];
    }
    return result;
  }

  [[nodiscard]] bool has_on_surface(const SurfacePoint& s) const {
    Vec3 outer, inner;
    for (std::size_t a = 0; a < 3; ++a) {
      outer[a] = s.position[a] + kStep * s.normal[a];
      inner[a] = s.position[a] - kStep * s.normal[a];
    }
    return inside(outer) != inside(inner);
  }
};

Solid cup_on_saucer() {
  const Vec3 bowl = {0, 0, 0.75};
  Solid solid;
  const auto add = [&](Block block, bool added) {
    solid.blocks.push_back(std::move(block));
    solid.added.push_back(added);
  };
  add(torus({0.62, 0, 0.72}, 0.24, 0.055, 1), true);  // handle
  add(sphere(bowl, 0.64), true);                      // cup
  add(cylinder(0.9, 1.05, 1.5), false);               // cut the cup open
  add(sphere(bowl, 0.57), false);                     // hollow it
  add(cylinder(0.32, 0.03, 0.2), true);               // foot
  add(cylinder(1.0, 0.0, 0.06), true);                // saucer
  add(torus({0, 0, 0.05}, 1.0, 0.06, 2), true);       // its rim
  return solid;
}

std::vector<Vec3> sample(const Solid& solid, std::size_t count) {
  double total = 0;
  for (const Block& block : solid.blocks) total += block.area;
  Random random;
  std::vector<Vec3> points;
  while (points.size() < count) {
    double part = random() * total;
    std::size_t i = 0;
    while (i + 1 < solid.blocks.size() && part >= solid.blocks[i].area) part -= solid.blocks[i++].area;
    const SurfacePoint candidate = solid.blocks[i].sample(random);
    if (solid.has_on_surface(candidate)) points.push_back(candidate.position);
  }
  return points;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t count = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : kDefaultCount;
  if (argc < 2 || argc > 3 || count == 0 || count > kMaxCount) {
    std::fputs("usage: sample_cloud OUT [COUNT]\n", stderr);
    return 64;
  }
  try {
    g3r::Cloud cloud;
    cloud.positions = sample(cup_on_saucer(), count);
    g3r::write_cloud(argv[1], cloud, nullptr, nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sample_cloud: %s\n", error.what());
    return 1;
  }
  return 0;
}
