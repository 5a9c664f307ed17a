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

}  // namespace

std::size_t planned_memory(const Settings& settings, std::size_t given, std::size_t used) {
  // Bytes, measured.
  constexpr double kProgram = 12e6;    // code, libraries, thread stacks, queries of the certificate
  constexpr double kMatrices = 180;    // of the expansions, that the far pairs of a cloud share: measured
  constexpr double kPerUnknown = 330;  // while the equations are solved,
  constexpr double kBase = 255;        // or what stays of it while sides are certified,
  constexpr double kPerSite = 430;     // and what each of the sites then takes: of closed clouds 400, of open ones 600;
  constexpr double kMoved = 100;       // under noise, besides, points that are moved onto their surface
  constexpr double kFilled = 0.7;      // as many as a maximal sample of points so far apart has, in squares of that side
  const std::size_t harmonics = settings.method == Method::kGreen ? settings.harmonics.size() : 0;
  const auto unknowns = static_cast<double>(used);
  const double solve = (kPerUnknown + 2 * sizeof(Vec3) * static_cast<double>(harmonics)) * unknowns;
  const double apart = site_distance(used, settings.spacing, settings.noise) / settings.spacing;
  const double sites = apart > 0 ? kFilled * unknowns / (apart * apart) : unknowns;
  const double certificate = (kBase + (settings.noise > 0 ? kMoved : 0)) * unknowns + kPerSite * sites;
  const SumPlan& sums = settings.first_sums;
  const auto terms = static_cast<double>(coefficient_count(sums.order));
  const double matrix = terms * terms * (sums.double_precision ? sizeof(double) : sizeof(float));
  const double expansions = sums.direct ? 0 : kMatrices * matrix;
  double bytes = kProgram + expansions + static_cast<double>(given * sizeof(Given)) + std::max(solve, certificate);
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
