#include "shape.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "shapes.h"

namespace g3r::stress {
namespace {

using shapes::Random;
using Formula = std::function<double(const Vec3&)>;
using Rotation = std::array<Vec3, 3>;  // rows

constexpr double kGradientStep = 1e-5;  // of central differences: rounding and curvature both stay below 1e-6

double length(double x, double y, double z = 0) { return std::sqrt(x * x + y * y + z * z); }

Rotation random_rotation(Random& random) {
  const Vec3 a = random.direction();
  Vec3 b = random.direction();
  const double along = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  for (std::size_t k = 0; k < 3; ++k) b[k] -= along * a[k];
  const double size = length(b[0], b[1], b[2]);
  for (double& c : b) c /= size;
  return {a, b, {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

Formula placed(Formula formula, const Rotation& rotation, const Vec3& centre) {
  return [=, formula = std::move(formula)](const Vec3& p) {
    const Vec3 q{p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
    Vec3 local;
    for (std::size_t k = 0; k < 3; ++k) local[k] = rotation[k][0] * q[0] + rotation[k][1] * q[1] + rotation[k][2] * q[2];
    return formula(local);
  };
}

// Exact distances (Quilez, "Distance functions").
Formula ball(double radius) {
  return [=](const Vec3& p) { return length(p[0], p[1], p[2]) - radius; };
}
Formula box(const Vec3& half) {
  return [=](const Vec3& p) {
    const Vec3 d{std::abs(p[0]) - half[0], std::abs(p[1]) - half[1], std::abs(p[2]) - half[2]};
    return length(std::max(d[0], 0.0), std::max(d[1], 0.0), std::max(d[2], 0.0)) + std::min(std::max({d[0], d[1], d[2]}), 0.0);
  };
}
Formula cylinder(double radius, double half) {
  return [=](const Vec3& p) {
    const double r = length(p[0], p[1]) - radius;
    const double z = std::abs(p[2]) - half;
    return std::min(std::max(r, z), 0.0) + length(std::max(r, 0.0), std::max(z, 0.0));
  };
}
Formula ring(double major, double minor) {
  return [=](const Vec3& p) { return length(length(p[0], p[1]) - major, p[2]) - minor; };
}
Formula tube(const Vec3& a, const Vec3& b, double radius) {
  return [=](const Vec3& p) {
    Vec3 ab;
    Vec3 ap;
    double along = 0;
    double size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      ab[k] = b[k] - a[k];
      ap[k] = p[k] - a[k];
      along += ab[k] * ap[k];
      size += ab[k] * ab[k];
    }
    const double t = std::clamp(along / size, 0.0, 1.0);
    return length(ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]) - radius;
  };
}
Formula egg(const Vec3& half) {  // a bound of the distance, exact on the surface
  const double least = std::min({half[0], half[1], half[2]});
  return [=](const Vec3& p) { return (length(p[0] / half[0], p[1] / half[1], p[2] / half[2]) - 1) * least; };
}
// Below a height made of `waves` sines.
Formula below_waves(int waves, double steepest, Random& random) {
  struct Wave {
    double x, y, phase, height;
  };
  std::vector<Wave> sines;
  double slope = 0;
  for (int i = 0; i < waves; ++i) {
    const double size = random.uniform(1, 8);
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    sines.push_back({size * std::cos(angle), size * std::sin(angle), random.uniform(0, 6), steepest / size / waves});
    slope += steepest / waves;
  }
  const double bound = std::sqrt(1 + slope * slope);
  return [=](const Vec3& p) {
    double height = 0;
    for (const Wave& w : sines) height += w.height * std::sin(w.x * p[0] + w.y * p[1] + w.phase);
    return (p[2] - height) / bound;
  };
}

Formula unite(Formula a, Formula b) {
  return [a = std::move(a), b = std::move(b)](const Vec3& p) { return std::min(a(p), b(p)); };
}
Formula intersect(Formula a, Formula b) {
  return [a = std::move(a), b = std::move(b)](const Vec3& p) { return std::max(a(p), b(p)); };
}
Formula without(Formula a, Formula b) {
  return [a = std::move(a), b = std::move(b)](const Vec3& p) { return std::max(a(p), -b(p)); };
}

Formula random_primitive(Random& random, double size) {
  const auto some = [&] { return size * random.uniform(0.4, 1); };
  switch (random.bits() % 5) {
    case 0:
      return ball(some());
    case 1: {
      const double x = some();
      const double y = some();
      return box({x, y, some()});
    }
    case 2: {
      const double radius = some();
      return cylinder(radius, some());
    }
    case 3: {
      const double major = some();
      return ring(major, major * random.uniform(0.15, 0.5));
    }
    default: {
      const double x = some();
      const double y = some();
      return egg({x, y, some()});
    }
  }
}

Formula random_mixture(int parts, Random& random) {
  Formula all = placed(random_primitive(random, 0.8), random_rotation(random), {0, 0, 0});
  for (int i = 1; i < parts; ++i) {
    const Rotation rotation = random_rotation(random);
    const Vec3 centre{random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7)};
    const double kind = random.uniform();
    Formula part = placed(random_primitive(random, kind < 0.5 ? 0.6 : 0.4), rotation, centre);
    all = kind < 0.5 ? unite(std::move(all), std::move(part)) : without(std::move(all), std::move(part));
  }
  return intersect(std::move(all), ball(1.6));  // within the ball that is sampled
}

bool everywhere(const Vec3&) { return true; }

Shape random_shell(int parts, Random& random) {
  const double half = 0.1 * std::pow(10, -random.uniform());
  Formula core = random_mixture(parts, random);
  Formula wall = [core = std::move(core), half](const Vec3& p) { return std::abs(core(p)) - half; };
  if (random.uniform() < 0.5) return {std::move(wall), everywhere};
  const Vec3 cut = random.direction();  // a bowl
  return {intersect(std::move(wall), [=](const Vec3& p) { return p[0] * cut[0] + p[1] * cut[1] + p[2] * cut[2] - 0.2; }), everywhere};
}

Shape random_wire(int parts, Random& random) {
  const double radius = 0.1 * std::pow(10, -0.8 * random.uniform());
  Vec3 from = random.direction();
  Formula all = ball(radius);
  for (int i = 0; i < parts + 1; ++i) {
    Vec3 to = random.direction();
    for (double& c : to) c *= 1.2;
    Formula part = random.uniform() < 0.2 ? placed(ring(0.5, radius), random_rotation(random), to) : tube(from, to, radius);
    all = i == 0 ? std::move(part) : unite(std::move(all), std::move(part));
    from = to;
  }
  return {intersect(std::move(all), ball(1.75)), everywhere};
}

Shape random_patch(int parts, Random& random) {
  const int kind = static_cast<int>(random.bits() % 3);
  const Rotation rotation = random_rotation(random);
  const Vec3& up = rotation[2];
  Formula value;
  if (kind == 0) {
    value = placed(below_waves(parts, random.uniform(0, 1.5), random), rotation, {0, 0, 0});
  } else {
    value = kind == 1 ? ball(1) : placed(cylinder(0.8, 5), rotation, {0, 0, 0});
  }
  const double cut = random.uniform(-0.6, 0.6);
  const bool square = random.uniform() < 0.5;
  Shape patch{std::move(value), nullptr, Sides::kEither};
  patch.exists = [=](const Vec3& p) {
    const double x = p[0] * rotation[0][0] + p[1] * rotation[0][1] + p[2] * rotation[0][2];
    const double z = p[0] * up[0] + p[1] * up[1] + p[2] * up[2];
    if (kind == 1) return z > cut;
    if (kind == 2) return x > cut && std::abs(z) < 1;
    return square ? std::max(std::abs(p[0]), std::abs(p[1])) < 1.1 : length(p[0], p[1], p[2]) < 1.2;
  };
  return patch;
}

Shape random_terrain(int parts, Random& random) {
  Formula ground = below_waves(2 * parts + 1, random.uniform(0, 2), random);
  for (int i = 1; i < parts; ++i) {  // houses
    const Vec3 half{random.uniform(0.05, 0.2), random.uniform(0.05, 0.2), random.uniform(0.3, 0.6)};
    const double angle = random.uniform(0, 1.5);
    const Rotation turned{Vec3{std::cos(angle), std::sin(angle), 0}, Vec3{-std::sin(angle), std::cos(angle), 0}, Vec3{0, 0, 1}};
    const double x = random.uniform(-0.9, 0.9);
    ground = unite(std::move(ground), placed(box(half), turned, {x, random.uniform(-0.9, 0.9), 0}));
  }
  return {std::move(ground), [](const Vec3& p) { return std::max(std::abs(p[0]), std::abs(p[1])) < 1.1 && std::abs(p[2]) < 1; },
          Sides::kEither};
}

// The air of a room with furniture on its floor.
Shape random_room(int parts, Random& random) {
  const Vec3 half{random.uniform(0.7, 1), random.uniform(0.5, 1), random.uniform(0.3, 0.5)};
  Formula air = box(half);
  for (int i = 1; i < parts; ++i) {
    const Vec3 size{random.uniform(0.05, 0.25), random.uniform(0.05, 0.25), random.uniform(0.05, 0.3)};
    const double x = random.uniform(-half[0], half[0]);
    const double y = random.uniform(-half[1], half[1]);
    air = without(std::move(air), placed(box(size), {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {x, y, size[2] - half[2]}));
  }
  Shape room{std::move(air), everywhere};
  room.seen_from_inside = true;
  return room;
}

}  // namespace

Shape make_shape(const std::string& family, int parts, std::uint64_t seed) {
  Random random(seed);
  if (family == "solid") return {random_mixture(parts, random), everywhere};
  if (family == "shell") return random_shell(parts, random);
  if (family == "wire") return random_wire(parts, random);
  if (family == "patch") return random_patch(parts, random);
  if (family == "terrain") return random_terrain(parts, random);
  if (family == "room") return random_room(parts, random);
  throw InvalidInput("no family of shapes is called " + family);
}

Vec3 normal_of(const Shape& shape, const Vec3& place) {
  Vec3 gradient;
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 low = place;
    Vec3 high = place;
    low[k] -= kGradientStep;
    high[k] += kGradientStep;
    gradient[k] = shape.value(high) - shape.value(low);
  }
  const double size = length(gradient[0], gradient[1], gradient[2]);
  if (size == 0) return {0, 0, 0};
  for (double& c : gradient) c /= size;
  return gradient;
}

}  // namespace g3r::stress
