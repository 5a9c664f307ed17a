// AE_p and PCO: normals against true normals.
#include <g3r/error.h>
#include <g3r/metrics.h>

#include <string>

#include "vector.h"

namespace g3r {

NormalScore score_normals(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  if (normals.size() != truth.size()) {
    throw InvalidInput("cannot score " + std::to_string(normals.size()) + " normals against " + std::to_string(truth.size()) +
                       " true normals");
  }
  if (normals.empty()) throw InvalidInput("there are no normals to score");
  double error = 0;
  std::size_t right = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (!vector::is_finite(normals[i]) || !vector::is_finite(truth[i])) {
      throw InvalidInput("normal " + std::to_string(i) + " is not finite");
    }
    const Vec3 n = vector::normalised(normals[i]);
    const Vec3 t = vector::normalised(truth[i]);
    if (vector::dot(t, t) == 0) throw InvalidInput("true normal " + std::to_string(i) + " is zero");
    const double cosine = vector::dot(n, t);
    error += (1 - cosine) / 2;
    right += cosine > 0 ? 1 : 0;
  }
  const auto count = static_cast<double>(normals.size());
  return {error / count, static_cast<double>(right) / count, normals.size()};
}

}  // namespace g3r
