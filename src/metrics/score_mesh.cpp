// CD, AE_m, HD, normal consistency and F-scores: a mesh against a true mesh.
#include <g3r/error.h>
#include <g3r/metrics.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "base/vector.h"
#include "cpu/parallel.h"
#include "metrics/triangle_tree.h"

namespace g3r {

namespace {

/// Sums over the samples of one mesh of what its closest points on the other mesh give.
struct OneWay {
  double distance = 0;
  double angle_error = 0;
  double farthest = 0;
  double consistency = 0;
  std::vector<std::size_t> within;  // of every distance asked for

  OneWay& operator+=(const OneWay& other) {
    distance += other.distance;
    angle_error += other.angle_error;
    farthest = std::max(farthest, other.farthest);
    consistency += other.consistency;
    for (std::size_t d = 0; d < within.size(); ++d) within[d] += other.within[d];
    return *this;
  }
};

OneWay compare(const Samples& samples, const TriangleTree& surface, const std::vector<double>& distances, const std::atomic<bool>* cancel) {
  OneWay none;
  none.within.assign(distances.size(), 0);
  return parallel::sum_blocks(samples.points.size(), parallel::kBlock, none, [&](std::size_t begin, std::size_t end) {
    if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) throw Cancelled();
    OneWay sum = none;
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleTree::Closest closest = surface.closest(samples.points[i]);
      const double cosine = vector::dot(samples.normals[i], surface.normal(closest.triangle));
      sum.distance += closest.distance;
      sum.angle_error += (1 - cosine) / 2;
      sum.farthest = std::max(sum.farthest, closest.distance);
      sum.consistency += std::abs(cosine);
      for (std::size_t d = 0; d < distances.size(); ++d) sum.within[d] += closest.distance <= distances[d] ? 1 : 0;
    }
    return sum;
  });
}

}  // namespace

MeshScore score_mesh(const Mesh& mesh, const Mesh& truth, const MeshScoreOptions& options, const Monitor& monitor) {
  const std::vector<double>& distances = options.distances;
  for (const double d : distances) {
    if (!(d > 0)) throw InvalidInput("the distance of an F-score must be above 0");
  }
  if (options.samples == 0) throw InvalidInput("the number of samples must be positive");
  const auto samples_of = [&](const Mesh& of) { return sample_mesh(of, options.samples, options.seed, 0, monitor); };
  const OneWay to_truth = compare(samples_of(mesh), TriangleTree(truth), distances, monitor.cancel);
  const OneWay to_mesh = compare(samples_of(truth), TriangleTree(mesh), distances, monitor.cancel);
  const auto count = static_cast<double>(options.samples);
  MeshScore score;
  score.chamfer = (to_truth.distance + to_mesh.distance) / (2 * count);
  score.ae = (to_truth.angle_error + to_mesh.angle_error) / (2 * count);
  score.hausdorff = std::max(to_truth.farthest, to_mesh.farthest);
  score.normal_consistency = (to_truth.consistency + to_mesh.consistency) / (2 * count);
  for (std::size_t d = 0; d < distances.size(); ++d) {
    const double precision = static_cast<double>(to_truth.within[d]) / count;
    const double recall = static_cast<double>(to_mesh.within[d]) / count;
    score.f_scores.push_back({distances[d], precision, recall, precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0});
  }
  return score;
}

}  // namespace g3r
