#include "orient/facets.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/spacing.h"
#include "orient/polish.h"
#include "solve/energy_system.h"
#include "solve/iterative_solver.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace g3r {
namespace {

// Cosine between the normals of a facet and of its seed: less lets facets follow curved surfaces.
constexpr double kParallel = 0.9995;
// At most: 20 to 40 are enough as a rule.
constexpr Steps kSteps{60, StepKind::kConjugateGradient};

// The normal of the first point of every facet, to whose side those of the others are turned.
std::vector<Vec3> first_normals(const Facets& facets, const std::vector<Vec3>& normals) {
  std::vector<Vec3> first(facets.count, Vec3{0, 0, 0});
  for (std::size_t i = normals.size(); i-- > 0;) {
    if (facets.of[i] != Facets::kNone) first[facets.of[i]] = normals[i];
  }
  return first;
}

// P M P x = P b.
class OnFacets : public LinearSystem {
 public:
  OnFacets(LinearSystem& system, const Facets& facets, const std::vector<double>& areas, const std::vector<Vec3>& normals)
      : system_(system), facets_(facets), areas_(areas), normals_(normals), squares_(facets.count, 0) {
    for (std::size_t i = 0; i < facets.of.size(); ++i) {
      if (facets.of[i] != Facets::kNone) squares_[facets.of[i]] += areas[i] * areas[i];
    }
  }
  [[nodiscard]] std::vector<Vec3> project(std::vector<Vec3> v) const {
    std::vector<double> sum(facets_.count, 0);
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (facets_.of[i] != Facets::kNone) sum[facets_.of[i]] += areas_[i] * vector::dot(normals_[i], v[i]);
    }
    for (std::size_t i = 0; i < v.size(); ++i) {
      const std::uint32_t f = facets_.of[i];
      if (f != Facets::kNone) v[i] = vector::scale(normals_[i], areas_[i] * sum[f] / squares_[f]);
    }
    return v;
  }
  std::vector<Vec3> apply(const std::vector<Vec3>& x) override { return project(system_.apply(x)); }
  std::vector<Vec3> right_side() override { return project(system_.right_side()); }

 private:
  LinearSystem& system_;
  const Facets& facets_;
  const std::vector<double>& areas_;
  const std::vector<Vec3>& normals_;
  std::vector<double> squares_;  // sum of A_i^2 of every facet
};

}  // namespace

Facets find_facets(const PointSet& set, const std::vector<std::uint8_t>& proven, const std::vector<Vec3>& normals) {
  const std::vector<Vec3>& points = set.points();
  const std::vector<double>& spacing = set.smoothed_spacing();
  const std::vector<std::uint32_t>& near = set.near();
  Facets facets;
  facets.of.assign(points.size(), Facets::kNone);
  if (points.size() < kSpacingNeighbours) return facets;
  const auto parallel = [&](std::size_t i, std::size_t j) { return std::abs(vector::dot(normals[i], normals[j])) >= kParallel; };
  const auto in_one_plane = [&](std::size_t i, std::size_t j) {
    const Vec3 d = vector::subtract(points[i], points[j]);
    return std::max(std::abs(vector::dot(normals[i], d)), std::abs(vector::dot(normals[j], d))) <=
           kExactWithin * std::min(spacing[i], spacing[j]);
  };
  std::vector<std::uint8_t> done(proven.size(), 0);
  std::vector<std::uint32_t> members;
  for (std::uint32_t seed = 0; seed < points.size(); ++seed) {
    if (proven[seed] == 0 || done[seed] != 0) continue;
    members.assign(1, seed);
    done[seed] = 1;
    for (std::size_t m = 0; m < members.size(); ++m) {
      const std::uint32_t i = members[m];
      for (std::size_t k = 1; k < kSpacingNeighbours; ++k) {
        const std::uint32_t j = near[i * kSpacingNeighbours + k];
        if (proven[j] == 0 || done[j] != 0 || !parallel(seed, j) || !in_one_plane(i, j)) continue;
        done[j] = 1;
        members.push_back(j);
      }
    }
    if (members.size() < kQuadraticTerms) continue;
    for (const std::uint32_t i : members) facets.of[i] = static_cast<std::uint32_t>(facets.count);
    ++facets.count;
  }
  return facets;
}

double minority_share(const Facets& facets, const std::vector<Vec3>& normals) {
  const std::vector<Vec3> first = first_normals(facets, normals);
  std::vector<std::size_t> same(facets.count, 0);
  std::vector<std::size_t> all(facets.count, 0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t f = facets.of[i];
    if (f == Facets::kNone) continue;
    ++all[f];
    same[f] += vector::dot(normals[i], first[f]) > 0 ? 1 : 0;
  }
  std::size_t odd = 0;
  for (std::size_t f = 0; f < facets.count; ++f) odd += std::min(same[f], all[f] - same[f]);
  return static_cast<double>(odd) / static_cast<double>(normals.size());
}

void choose_facet_sides(const PointSet& set, const Settings& settings, const Facets& facets, std::vector<Vec3>& eta,
                        std::vector<Vec3>& normals, Stages& stages) {
  const std::vector<double>& spacing = set.smoothed_spacing();
  const std::vector<Vec3> first = first_normals(facets, normals);
  std::vector<Vec3> turned = normals;
  std::vector<double> areas(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) {
    areas[i] = spacing[i] * spacing[i];
    if (facets.of[i] != Facets::kNone && vector::dot(normals[i], first[facets.of[i]]) < 0) turned[i] = vector::scale(normals[i], -1);
  }
  FastSum sum(set.points(), set.morton(), local_widths(settings.polish_epsilon, settings, spacing), settings.first_sums, stages.cancel());
  EnergySystem free(sum, 0, settings.polish_winding_weight);
  OnFacets system(free, facets, areas, turned);
  const auto still_going = [&stages](int, int, double) { stages.still_going(); };
  const std::vector<Vec3> solved = solve_iteratively(system, {kSteps}, settings.doubtful_tolerance, system.project(eta), still_going).eta;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (facets.of[i] == Facets::kNone) continue;
    normals[i] = vector::scale(turned[i], vector::dot(solved[i], turned[i]) < 0 ? -1 : 1);
    eta[i] = vector::scale(normals[i], areas[i]);
  }
}

}  // namespace g3r
