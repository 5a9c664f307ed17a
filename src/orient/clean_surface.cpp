#include "orient/clean_surface.h"

#include "base/vector.h"
#include "cloud/noise.h"
#include "orient/confidence.h"
#include "orient/facet_normals.h"
#include "orient/facets.h"
#include "orient/jets.h"
#include "orient/planes.h"
#include "orient/polish.h"
#include "orient/site_parts.h"
#include "solve/refine.h"
#include "sum/fast_sum.h"

#include <cstddef>

namespace g3r {
namespace {

// v, turned as from one unit vector to another: half round the middle of both.
Vec3 turned(const Vec3& v, const Vec3& from, const Vec3& to) {
  if (from == to) return v;
  const Vec3 middle = vector::normalised(vector::add(from, to));  // 0 of opposite ones
  return vector::subtract(vector::scale(middle, 2 * vector::dot(middle, v)), v);
}

// About facets whose sides are decided as one: more may be that of two walls, whose directions are one all the same.
double scatter_of_one_side(const Problem& problem) { return problem.scatter < kLeastNoise * problem.spacing ? problem.scatter : 0; }

Facets facets_of(const Problem& problem, double scatter, const std::vector<std::uint8_t>& proven, const std::vector<Vec3>& normals) {
  return find_facets(problem.cloud.set, proven, normals, scatter, problem.known.wanted);
}

// Where the points of a cloud's facets disagree about their sides, every facet gets one, and the other points their normals from the field
// of what the facets have become. `fit` proves normals; `proven`: those it has. Returns the facets in the end.
template <typename Fit>
Facets agree_on_facets(const Problem& problem, const std::vector<std::uint8_t>& proven, const Fit& fit, std::vector<Vec3>& eta,
                       std::vector<Vec3>& normals, Stages& stages) {
  const PointSet& set = problem.cloud.set;
  const Settings& s = problem.settings;
  const double scatter = scatter_of_one_side(problem);
  Facets facets = facets_of(problem, scatter, proven, normals);
  for (int round = 0; round < kMostRounds && minority_share(facets, normals, problem.known.wanted) >= kMinMinority; ++round) {
    make_room_for_sums(set);
    choose_facet_sides(set, s, facets, eta, normals, stages);
    FastSum sum(set.points(), local_widths(s.polish.width, s, set.smoothed_spacing()), s.sums, stages.cancel());
    const Refinement refined = refine_normals(sum, eta);
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (facets.of[i] == Facets::kNone) normals[i] = refined.normals[i];
    }
    fit();
    facets = facets_of(problem, scatter, proven, normals);
  }
  return facets;
}

}  // namespace

std::vector<std::uint8_t> fit_directions(const Problem& problem, std::vector<Vec3>& normals) {
  std::vector<std::uint8_t> proven(normals.size(), 0);
  if (runs(problem, Step::kJets)) proven = fit_jets(problem.cloud.set, normals);
  if (runs(problem, Step::kPlanes)) fit_planes(problem.cloud.set, problem.scatter, proven, normals);
  return proven;
}

void fit_clean_surface(const Problem& problem, std::vector<Vec3>& eta, std::vector<Vec3>& normals, Stages& stages) {
  std::vector<std::uint8_t> proven;
  const auto fit = [&] { proven = fit_directions(problem, normals); };
  fit();
  Facets facets;
  std::vector<Vec3> before;
  if (runs(problem, Step::kFacets)) {
    facets = agree_on_facets(problem, proven, fit, eta, normals, stages);
    before = normals;
    turn_single_points(problem.cloud.set, facets, problem.known.wanted, normals);
    if (problem.scatter != scatter_of_one_side(problem)) facets = facets_of(problem, problem.scatter, proven, normals);
  }
  if (before.empty()) before = normals;
  follow_facets(problem.cloud.set, facets, problem.known.wanted, normals);
  for (std::size_t i = 0; i < facets.of.size(); ++i) {
    if (facets.of[i] != Facets::kNone) proven[i] = 1;
  }
  if (runs(problem, Step::kCreases)) fit_jets_at_creases(problem.cloud.set, proven, normals);
  // Area vectors turn with them: how far both agree tells the side, not the direction.
  for (std::size_t i = 0; i < normals.size(); ++i) eta[i] = turned(eta[i], before[i], normals[i]);
}

}  // namespace g3r
