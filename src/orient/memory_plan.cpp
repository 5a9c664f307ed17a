#include "orient/memory_plan.h"

#include "base/whole_bytes.h"
#include "expansions/expansions.h"
#include "orient/site_parts.h"
#include "sum/sum_plan.h"

#include <g3r/error.h>
#include <g3r/points.h>

#include <algorithm>
#include <cstdint>
#include <string>

namespace g3r {
namespace {

// What the program has of every point that it is given: input, result, and which of the distinct points it is.
struct Given {
  Vec3 point, normal;
  double area;
  float confidence;
  std::uint32_t index, multiplicity;
};

// The numbers below are bytes and have been measured (docs/evidence/speed.md): if too little is planned a run is killed, if too much it is
// refused for nothing.
// Code, libraries, the stacks of threads and the queries of the certificate take so many.
constexpr double kProgramBytes = 12e6;
// A point takes so many while the equations are solved.
constexpr double kBytesPerUnknown = 330;
// Of these so many stay while the sides are certified.
constexpr double kBytesPerCertified = 255;
// A site of the certificate takes so many: 400 on closed surfaces, 600 on open ones.
constexpr double kBytesPerSite = 430;
// Under noise a point that is moved onto its surface takes so many besides.
constexpr double kBytesPerMoved = 100;
// Not bytes: the matrices of the expansions that the far pairs of a cloud share.
constexpr double kSharedMatrices = 180;
// Not bytes: the sites of a maximal Poisson disk sample, for each square of its distance.
constexpr double kSitesPerSquare = 0.7;

}  // namespace

std::size_t planned_memory(const Settings& settings, std::size_t given, std::size_t used) {
  const std::size_t harmonics = settings.method == Method::kGreen ? settings.harmonics.size() : 0;
  const auto unknowns = static_cast<double>(used);
  const double solve = (kBytesPerUnknown + 2 * sizeof(Vec3) * static_cast<double>(harmonics)) * unknowns;
  const double apart = site_distance(used, settings.spacing, settings.noise) / settings.spacing;
  const double sites = apart > 0 ? kSitesPerSquare * unknowns / (apart * apart) : unknowns;
  const double certificate = (kBytesPerCertified + (settings.noise > 0 ? kBytesPerMoved : 0)) * unknowns + kBytesPerSite * sites;
  const SumPlan& sums = settings.first_sums;
  const auto terms = static_cast<double>(coefficient_count(sums.order));
  const double matrix = terms * terms * (sums.double_precision ? sizeof(double) : sizeof(float));
  const double expansions = sums.direct ? 0 : kSharedMatrices * matrix;
  double bytes = kProgramBytes + expansions + static_cast<double>(given * sizeof(Given)) + std::max(solve, certificate);
  const double matrices = settings.condition_number ? 2 : 1;  // of the dense system, and the copy that is brought to three diagonals
  if (settings.dense) bytes += matrices * 3 * unknowns * 3 * unknowns * sizeof(double);
  return whole_bytes(bytes);
}

void require_memory(std::size_t planned_bytes, std::size_t limit, bool makes_mesh) {
  if (limit == 0 || planned_bytes <= limit) return;
  throw Unavailable("the plan needs " + std::to_string(mebibytes_needed(planned_bytes)) + " MiB, the limit is " +
                    std::to_string(mebibytes(limit)) + " MiB; raise the limit" +
                    (makes_mesh ? ", thin the cloud, or lower the depth of the mesh" : " or thin the cloud"));
}

}  // namespace g3r
