#include "ceiling.h"

#include <g3r/error.h>
#include <g3r/metrics.h>

#include <cmath>

#include "base/vector.h"
#include "cloud/neighbours.h"
#include "metrics/random.h"

namespace g3r::bench {

namespace {

constexpr std::size_t kSamples = 400000;  // of the true surface: 100 within 5 s on the models at s = 0.25 % of the diagonal
constexpr double kReach = 5;              // standard deviations: farther away the weight is below 4e-6
constexpr std::uint64_t kSurfaceStream = 103;

}  // namespace

std::vector<Vec3> ceiling_normals(const Mesh& truth, const Input& input, std::uint64_t seed) {
  if (input.noise == 0) throw InvalidInput("the method ceiling is of noise: give --inputs noise:P");
  const Samples surface = sample_mesh(truth, kSamples, Random(seed, kSurfaceStream).bits());
  const Neighbours tree(surface.points);
  std::vector<Vec3> normals(input.surface);
  std::vector<std::uint32_t> near;
  for (std::size_t i = 0; i < input.surface; ++i) {
    const Vec3& x = input.points[i];
    tree.within(x, kReach * input.noise, near);
    Vec3 sum{0, 0, 0};
    for (const std::uint32_t j : near) {
      const Vec3 d = vector::subtract(x, surface.points[j]);
      sum = vector::add(sum, vector::scale(surface.normals[j], std::exp(-vector::dot(d, d) / (2 * input.noise * input.noise))));
    }
    double squared = HUGE_VAL;
    normals[i] = near.empty() ? surface.normals[tree.nearest(x, squared, 0)] : vector::normalised(sum);
  }
  return normals;
}

}  // namespace g3r::bench
