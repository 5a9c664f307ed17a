#include "orient/outlier_normals.h"

#include "base/vector.h"
#include "cloud/clusters.h"
#include "solve/refine.h"
#include "sum/fast_sum.h"

#include <cstddef>

namespace g3r {
namespace {

// The gradient of the winding field at the outliers: that of the groups of points where these were solved for, whose kernels are so wide
// that the pairs of single points would fill the memory.
std::vector<Vec3> gradient_at_outliers(const Problem& problem, const std::vector<Vec3>& eta, Stages& stages) {
  const Settings& s = problem.settings;
  const PointSet& set = problem.cloud.set;
  const Widths widths(s.refinement_width.typical());
  if (s.cluster_side == 0) {
    return FastSum(set.points(), widths, s.sums, stages.cancel()).winding_gradient_at(eta, problem.outliers, stages.cancel());
  }
  const Clusters clusters = cluster_points(set.points(), s.cluster_side);
  std::vector<Vec3> together(clusters.points.size(), Vec3{0, 0, 0});
  for (std::size_t i = 0; i < eta.size(); ++i) {
    Vec3& sum = together[clusters.cluster_of[i]];
    sum = vector::add(sum, eta[i]);
  }
  return FastSum(clusters.points, widths, s.sums, stages.cancel()).winding_gradient_at(together, problem.outliers, stages.cancel());
}

}  // namespace

void add_outliers(const Problem& problem, Stages& stages, Solution& solution, std::vector<float>& confidence) {
  if (problem.outliers.empty()) return;
  const std::vector<Vec3> none(problem.outliers.size(), Vec3{0, 0, 0});
  const std::vector<Vec3> normals = unit_normals(gradient_at_outliers(problem, solution.eta, stages), none).normals;
  solution.refinement.normals.insert(solution.refinement.normals.end(), normals.begin(), normals.end());
  solution.eta.insert(solution.eta.end(), none.begin(), none.end());
  confidence.insert(confidence.end(), none.size(), 0.0F);
}

}  // namespace g3r
