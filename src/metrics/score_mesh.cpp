// CD, AE_m and HD: a mesh against a true mesh.
#include <g3r/error.h>
#include <g3r/metrics.h>

#include <algorithm>

#include "cpu/parallel.h"
#include "metrics/triangle_tree.h"
#include "vector.h"

namespace g3r {

namespace {

constexpr std::size_t kBlock = 1024;

/// Sums over the samples of one mesh of what its closest points on the other mesh give.
struct Side {
  double distance = 0;
  double angle_error = 0;
  double farthest = 0;

  Side& operator+=(const Side& other) {
    distance += other.distance;
    angle_error += other.angle_error;
    farthest = std::max(farthest, other.farthest);
    return *this;
  }
};

Side compare(const Samples& samples, const TriangleTree& surface) {
  return parallel::sum_blocks(samples.points.size(), kBlock, Side{}, [&](std::size_t begin, std::size_t end) {
    Side sum;
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleTree::Closest closest = surface.closest(samples.points[i]);
      const double angle_error = (1 - vector::dot(samples.normals[i], surface.normal(closest.triangle))) / 2;
      sum += {closest.distance, angle_error, closest.distance};
    }
    return sum;
  });
}

}  // namespace

MeshScore score_mesh(const Mesh& mesh, const Mesh& truth, std::size_t samples, std::uint64_t seed) {
  if (samples == 0) throw InvalidInput("the number of samples must be positive");
  const Side to_truth = compare(sample_mesh(mesh, samples, seed), TriangleTree(truth));
  const Side to_mesh = compare(sample_mesh(truth, samples, seed), TriangleTree(mesh));
  const auto count = static_cast<double>(samples);
  MeshScore score;
  score.chamfer = (to_truth.distance + to_mesh.distance) / (2 * count);
  score.ae = (to_truth.angle_error + to_mesh.angle_error) / (2 * count);
  score.hausdorff = std::max(to_truth.farthest, to_mesh.farthest);
  return score;
}

}  // namespace g3r
