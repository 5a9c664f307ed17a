// Oriented samples of analytic shapes, and fields to mesh them with.
#pragma once

#include <g3r/points.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "cpu/parallel.h"
#include "mesh/field_sampler.h"

namespace g3r::testing {

struct OrientedSample {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
};

/// N points uniform on a sphere; `outward` = -1 turns the normals inwards.
inline OrientedSample sphere_sample(std::size_t n, double radius, std::uint64_t seed, double outward = 1) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> normal;
  OrientedSample out;
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 d{normal(rng), normal(rng), normal(rng)};
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    Vec3 p{};
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = radius * d[a] / length;
      d[a] *= outward / length;
    }
    out.points.push_back(p);
    out.normals.push_back(d);
  }
  return out;
}

/// N points uniform on the surface of the cube [-half, half]^3.
inline OrientedSample cube_sample(std::size_t n, double half, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(-half, half);
  OrientedSample out;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t axis = i % 3;
    const double side = (i / 3) % 2 == 0 ? 1 : -1;
    Vec3 p{uniform(rng), uniform(rng), uniform(rng)}, d{0, 0, 0};
    p[axis] = side * half;
    d[axis] = side;
    out.points.push_back(p);
    out.normals.push_back(d);
  }
  return out;
}

/// A field made from a signed distance (negative inside): 1 inside, 0 outside, a linear ramp of the given half width between.
struct DistanceSampler : FieldSampler {
  std::function<double(const Vec3&)> distance;
  double half_width;
  DistanceSampler(std::function<double(const Vec3&)> f, double width) : distance(std::move(f)), half_width(width) {}
  void sample(const std::vector<Vec3>& queries, std::vector<double>& value, std::vector<Vec3>* gradient) const override {
    value.resize(queries.size());
    for (std::size_t i = 0; i < queries.size(); ++i) value[i] = std::clamp(0.5 - distance(queries[i]) / (2 * half_width), 0.0, 1.0);
    if (gradient != nullptr) gradient->assign(queries.size(), Vec3{0, 0, 0});
  }
};

/// The winding field of points of equal area, summed directly: w(x) = sum g_s(|y - x|) (y - x) . eta.
struct DirectSampler : FieldSampler {
  OrientedSample sources;
  double area, width;
  DirectSampler(OrientedSample s, double point_area, double mollifier) : sources(std::move(s)), area(point_area), width(mollifier) {}
  void sample(const std::vector<Vec3>& queries, std::vector<double>& value, std::vector<Vec3>* gradient) const override {
    value.resize(queries.size());
    if (gradient != nullptr) gradient->assign(queries.size(), Vec3{0, 0, 0});
    parallel::for_blocks(queries.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) value[i] = at(queries[i]);
    });
  }
  [[nodiscard]] double at(const Vec3& x) const {
    double sum = 0;
    for (std::size_t j = 0; j < sources.points.size(); ++j) {
      const Vec3 &y = sources.points[j], &n = sources.normals[j];
      const Vec3 r{y[0] - x[0], y[1] - x[1], y[2] - x[2]};
      const double rho = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), t = rho / (std::sqrt(2.0) * width);
      const double g = t < 1e-6 ? std::sqrt(2 / M_PI) / (12 * M_PI * width * width * width)
                                : (std::erf(t) - std::sqrt(2 / M_PI) * rho / width * std::exp(-t * t)) / (4 * M_PI * rho * rho * rho);
      sum += g * area * (r[0] * n[0] + r[1] * n[1] + r[2] * n[2]);
    }
    return sum;
  }
};

}  // namespace g3r::testing
