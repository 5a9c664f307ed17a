// AE_p, PCO, RMSE and PGP: normals against true normals.
#include <g3r/error.h>
#include <g3r/metrics.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/vector.h"

namespace g3r {

NormalScore score_normals(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  if (normals.size() != truth.size()) {
    throw InvalidInput("cannot score " + std::to_string(normals.size()) + " normals against " + std::to_string(truth.size()) +
                       " true normals");
  }
  if (normals.empty()) throw InvalidInput("there are no normals to score");
  NormalScore score;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (!vector::is_finite(normals[i]) || !vector::is_finite(truth[i])) {
      throw InvalidInput("normal " + std::to_string(i) + " is not finite");
    }
    const Vec3 n = vector::normalised(normals[i]);
    const Vec3 t = vector::normalised(truth[i]);
    if (vector::dot(t, t) == 0) throw InvalidInput("true normal " + std::to_string(i) + " is zero");
    const double cosine = vector::dot(n, t);
    const Vec3 sine = vector::cross(n, t);
    const double angle = cosine == 0 ? 90 : std::atan2(std::sqrt(vector::dot(sine, sine)), cosine) * 180 / std::numbers::pi;
    const double off_line = std::min(angle, 180 - angle);
    score.ae += (1 - cosine) / 2;
    score.pco += cosine > 0 ? 1 : 0;
    score.rmse += angle * angle;
    score.rmse_unoriented += off_line * off_line;
    score.pgp5 += off_line < 5 ? 1 : 0;
    score.pgp10 += off_line < 10 ? 1 : 0;
  }
  const auto count = static_cast<double>(normals.size());
  for (double* mean : {&score.ae, &score.pco, &score.rmse, &score.rmse_unoriented, &score.pgp5, &score.pgp10}) *mean /= count;
  score.rmse = std::sqrt(score.rmse);
  score.rmse_unoriented = std::sqrt(score.rmse_unoriented);
  score.points = normals.size();
  return score;
}

}  // namespace g3r
