// Sources: random lines meet a surface uniformly by area, and 2 pi R^2 times the mean number of meetings is its area (Crofton's formula, R
// the radius of the ball that the lines are drawn through).
#include "sampling.h"

#include <g3r/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shapes.h"

namespace g3r::stress {
namespace {

using shapes::Random;

constexpr double kLeastStep = 2e-3;         // along a line; thinner walls can be missed
constexpr int kBisections = 40;             // of a step: to the last digits
constexpr std::size_t kAreaLines = 2000;    // an area within a few percent
constexpr std::size_t kLinesPerPoint = 60;  // from so many on, the surface is given up as too small

struct Line {
  Vec3 origin;
  Vec3 direction;
  [[nodiscard]] Vec3 at(double t) const {
    return {origin[0] + t * direction[0], origin[1] + t * direction[1], origin[2] + t * direction[2]};
  }
};

void meet(const Shape& shape, const Line& line, bool first_only, std::vector<Vec3>& out) {
  double t = 0;
  double before = shape.value(line.at(0));
  while (t < 2 * kShapeRadius) {
    const double next = t + std::max(std::abs(before), kLeastStep);
    const double after = shape.value(line.at(next));
    if ((before < 0) != (after < 0)) {
      double low = t;
      double high = next;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = (low + high) / 2;
        ((shape.value(line.at(middle)) < 0) == (before < 0) ? low : high) = middle;
      }
      const Vec3 place = line.at((low + high) / 2);
      if (shape.exists(place)) {
        out.push_back(place);
        if (first_only) return;
      }
    }
    t = next;
    before = after;
  }
}

struct Frame {
  Vec3 x, y, z;
};

Frame frame_of(const Vec3& z) {
  const Vec3 other = std::abs(z[0]) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  Vec3 x{z[1] * other[2] - z[2] * other[1], z[2] * other[0] - z[0] * other[2], z[0] * other[1] - z[1] * other[0]};
  const double size = std::hypot(x[0], x[1], x[2]);
  for (double& c : x) c /= size;
  return {x, {z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]}, z};
}

// The line along z through (u, v) of the plane across it, from outside the ball.
Line along(const Frame& frame, double u, double v) {
  Line line{{}, frame.z};
  for (std::size_t k = 0; k < 3; ++k) line.origin[k] = u * frame.x[k] + v * frame.y[k] - kShapeRadius * frame.z[k];
  return line;
}

Line random_line(Random& random) {
  const Frame frame = frame_of(random.direction());
  const double radius = kShapeRadius * std::sqrt(random.uniform());
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  return along(frame, radius * std::cos(angle), radius * std::sin(angle));
}

double area_of(const Shape& shape, Random random) {
  std::vector<Vec3> met;
  for (std::size_t i = 0; i < kAreaLines; ++i) meet(shape, random_line(random), false, met);
  return 2 * std::numbers::pi * kShapeRadius * kShapeRadius * static_cast<double>(met.size()) / kAreaLines;
}

template <typename MakeLine, typename Keep>
std::vector<Vec3> along_lines(const Shape& shape, std::size_t count, bool first_only, MakeLine&& make_line, Keep&& keep) {
  std::vector<Vec3> points;
  std::vector<Vec3> met;
  for (std::size_t i = 0; i < kLinesPerPoint * (count + kAreaLines) && points.size() < count; ++i) {
    met.clear();
    meet(shape, make_line(), first_only, met);
    for (const Vec3& p : met) {
      if (points.size() < count && keep(p)) points.push_back(p);
    }
  }
  return points;
}

bool all(const Vec3&) { return true; }

std::vector<Vec3> in_lines(const Shape& shape, std::size_t count, double spacing, Random& random) {
  const Vec3 across = random.direction();
  const double gap = spacing * random.uniform(1.5, 6);
  const double shift = random.uniform(0, gap);
  const auto planes = static_cast<std::uint64_t>(std::ceil(2 * kShapeRadius / gap));
  return along_lines(
      shape, count, false,
      [&] {
        const double height = -kShapeRadius + shift + gap * static_cast<double>(random.bits() % planes);
        const double angle = random.uniform(0, 2 * std::numbers::pi);
        const Frame frame = frame_of(across);
        Vec3 direction;
        for (std::size_t k = 0; k < 3; ++k) direction[k] = std::cos(angle) * frame.x[k] + std::sin(angle) * frame.y[k];
        const Vec3 side{across[1] * direction[2] - across[2] * direction[1], across[2] * direction[0] - across[0] * direction[2],
                        across[0] * direction[1] - across[1] * direction[0]};
        return along({side, across, direction}, random.uniform(-kShapeRadius, kShapeRadius), height);
      },
      all);
}

std::vector<Vec3> on_raster(const Shape& shape, std::size_t count, double spacing, Random& random) {
  const Frame frame = random.uniform() < 0.5 ? Frame{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}} : frame_of(random.direction());
  const double pitch = std::max(spacing, 2 * kShapeRadius / std::sqrt(static_cast<double>(kLinesPerPoint * (count + kAreaLines))));
  std::vector<Vec3> points;
  const auto half = static_cast<int>(kShapeRadius / pitch);
  for (int i = -half; i <= half && points.size() < count; ++i) {
    for (int j = -half; j <= half && points.size() < count; ++j) meet(shape, along(frame, i * pitch, j * pitch), false, points);
  }
  points.resize(std::min(points.size(), count));
  return points;
}

Vec3 place_of_scanner(const Shape& shape, Random& random) {
  for (int attempt = 0; shape.seen_from_inside && attempt < 1000; ++attempt) {
    const Vec3 place{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.5, 0.5)};
    if (shape.value(place) < -0.03) return place;
  }
  Vec3 place = random.direction();
  for (double& c : place) c *= 0.99 * kShapeRadius;
  return place;
}

std::vector<Vec3> from_views(const Shape& shape, std::size_t count, Random& random) {
  std::vector<Vec3> places;
  const std::size_t views = 1 + random.bits() % 4;
  for (std::size_t i = 0; i < views; ++i) places.push_back(place_of_scanner(shape, random));
  return along_lines(
      shape, count, true,
      [&] {
        return Line{places[random.bits() % views], random.direction()};
      },
      all);
}

}  // namespace

Sampled sample(const Shape& shape, const std::string& sampling, std::size_t count, std::uint64_t seed) {
  Random random(seed ^ 0x73616d706c65ULL);
  Sampled out;
  out.area = area_of(shape, random);
  const double spacing = std::sqrt(out.area / static_cast<double>(count));
  if (sampling == "uniform") {
    out.points = along_lines(
        shape, count, false, [&] { return random_line(random); }, all);
  } else if (sampling == "uneven") {
    const Vec3 denser = random.direction();
    const double steepness = random.uniform(0.3, 1.3);  // e^(2 * 1.8 * 1.3) = 108
    const auto keep = [&](const Vec3& p) {
      return random.uniform() < std::exp(steepness * (p[0] * denser[0] + p[1] * denser[1] + p[2] * denser[2] - kShapeRadius));
    };
    out.points = along_lines(
        shape, count, false, [&] { return random_line(random); }, keep);
  } else if (sampling == "lines") {
    out.points = in_lines(shape, count, spacing, random);
  } else if (sampling == "raster") {
    out.points = on_raster(shape, count, spacing, random);
  } else if (sampling == "views") {
    out.points = from_views(shape, count, random);
  } else {
    throw InvalidInput("no sampling is called " + sampling);
  }
  return out;
}

}  // namespace g3r::stress
