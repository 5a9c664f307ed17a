#include "orient/facets.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/plane_fit.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"
#include "orient/polish.h"
#include "orient/unsure.h"
#include "orient/wanted.h"
#include "solve/energy_system.h"
#include "solve/iterative_solver.h"
#include "solve/part_system.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace g3r {
namespace {

// The normal of the first point of every facet, to whose side those of the others are turned.
std::vector<Vec3> first_normals(const Facets& facets, const std::vector<Vec3>& normals) {
  std::vector<Vec3> first(facets.count, Vec3{0, 0, 0});
  for (std::size_t i = normals.size(); i-- > 0;) {
    if (facets.of[i] != Facets::kNone) first[facets.of[i]] = normals[i];
  }
  return first;
}

// 1 for each point whose normal is on another side than that of most points of its facet; of halves, the first point's.
std::vector<std::uint8_t> in_minority(const Facets& facets, const std::vector<Vec3>& normals) {
  const std::vector<Vec3> first = first_normals(facets, normals);
  std::vector<std::size_t> same(facets.count, 0), all(facets.count, 0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t f = facets.of[i];
    if (f == Facets::kNone) continue;
    ++all[f];
    same[f] += vector::dot(normals[i], first[f]) > 0 ? 1 : 0;
  }
  std::vector<std::uint8_t> out(normals.size(), 0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t f = facets.of[i];
    out[i] = f != Facets::kNone && (vector::dot(normals[i], first[f]) > 0) == (2 * same[f] <= all[f]) ? 1 : 0;
  }
  return out;
}

// Area vectors that are c_f A_i n_i on facets, and the projector P on them.
class Subspace {
 public:
  Subspace(const Facets& facets, std::vector<double> areas, std::vector<Vec3> normals)
      : facets_(facets), areas_(std::move(areas)), normals_(std::move(normals)), squares_(facets.count, 0) {
    for (std::size_t i = 0; i < facets.of.size(); ++i) {
      if (facets.of[i] != Facets::kNone) squares_[facets.of[i]] += areas_[i] * areas_[i];
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

 private:
  const Facets& facets_;
  std::vector<double> areas_;
  std::vector<Vec3> normals_;
  std::vector<double> squares_;  // sum of A_i^2 of every facet
};

// P M P.
class OnFacets : public LinearSystem {
 public:
  OnFacets(LinearSystem& system, const Subspace& subspace) : system_(system), subspace_(subspace) {}
  void apply(const std::vector<Vec3>& x, std::vector<Vec3>& product) override {
    system_.apply(x, product);
    product = subspace_.project(std::move(product));
  }
  std::vector<Vec3> right_side() override { return subspace_.project(system_.right_side()); }

 private:
  LinearSystem& system_;
  const Subspace& subspace_;
};

// The normals, those of every facet on the side of its first point's.
std::vector<Vec3> turned_to_first(const Facets& facets, std::vector<Vec3> normals) {
  const std::vector<Vec3> first = first_normals(facets, normals);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t f = facets.of[i];
    if (f != Facets::kNone && vector::dot(normals[i], first[f]) < 0) normals[i] = vector::scale(normals[i], -1);
  }
  return normals;
}

// Which points are on facets whose sides are unsure: their points disagree, or |c_f| of `eta`, on the side of the normals, is
// less than kMostOf: with 0.5 single facets stay wrong as a whole, with 1 nearly all are solved for.
std::vector<std::uint8_t> unsure_facets(const Facets& facets, const std::vector<double>& areas, const std::vector<Vec3>& turned,
                                        const std::vector<Vec3>& normals, const std::vector<Vec3>& eta) {
  std::vector<std::uint8_t> is_unsure(facets.count, 0);
  const std::vector<Vec3> mean = Subspace(facets, areas, turned).project(eta);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (facets.of[i] == Facets::kNone) continue;
    const bool is_against = vector::dot(normals[i], turned[i]) < 0;
    if (is_against || vector::dot(mean[i], normals[i]) < kMostOf * areas[i]) is_unsure[facets.of[i]] = 1;
  }
  std::vector<std::uint8_t> unsure(normals.size(), 0);
  for (std::size_t i = 0; i < unsure.size(); ++i) unsure[i] = facets.of[i] == Facets::kNone ? 0 : is_unsure[facets.of[i]];
  return unsure;
}

// Standard error, in radians, of the normal of a plane through half of kPlaneNeighbours points, which fill a disc and scatter by `relative`
// spacings: 2 relative / (radius sqrt(n)), radius = sqrt(n / pi).
double error_of_plane(double relative) {
  constexpr double kHalf = kPlaneNeighbours / 2.0;
  return 2 * std::sqrt(std::numbers::pi) * relative / kHalf;
}

FacetPlane plane_through(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& members) {
  Vec3 sum{0, 0, 0};
  for (const std::uint32_t i : members) sum = vector::add(sum, points[i]);
  return {fit_plane(points, members.data(), members.size()).normal, vector::scale(sum, 1 / static_cast<double>(members.size()))};
}

// Facets around seeds, one at a time.
class FacetGrowth {
 public:
  FacetGrowth(const PointSet& set, const std::vector<std::uint8_t>& proven, const std::vector<Vec3>& normals, double scatter)
      : points_(set.points()),
        spacing_(set.smoothed_spacing()),
        near_(set.near()),
        proven_(proven),
        normals_(normals),
        scatter_(scatter),
        turned_by_(std::max(kExactScatter, std::pow(kSigmas * error_of_plane(scatter / set.spacing()), 2) / 2)),
        tried_(set.size(), 0) {}

  // Proven points beside others of their plane, those that have most of them first.
  [[nodiscard]] std::vector<std::uint32_t> seeds() const {
    std::vector<std::uint8_t> beside(points_.size(), 0);
    parallel::for_all(points_.size(), [&](std::size_t i) {
      if (proven_[i] == 0) return;
      const FacetPlane own{normals_[i], points_[i]};
      for (std::size_t k = 1; k < kSpacingNeighbours; ++k) {
        const std::uint32_t j = near_[i * kSpacingNeighbours + k];
        if (is_parallel(own, j) && is_within(own, std::numbers::sqrt2, j)) ++beside[i];
      }
    });
    std::vector<std::uint32_t> seeds;
    for (std::size_t most = kSpacingNeighbours; most-- > 1;) {
      for (std::uint32_t i = 0; i < points_.size(); ++i) {
        if (beside[i] == most) seeds.push_back(i);
      }
    }
    return seeds;
  }

  [[nodiscard]] bool is_taken(std::uint32_t i) const { return tried_[i] == kTaken; }
  void take(const std::vector<std::uint32_t>& members) {
    for (const std::uint32_t i : members) tried_[i] = kTaken;
  }

  // The seed and what of no facet joins it.
  const std::vector<std::uint32_t>& from(std::uint32_t seed) {
    ++round_;
    members_.assign(1, seed);
    tried_[seed] = round_;
    FacetPlane plane{normals_[seed], points_[seed]};
    double deviations = std::numbers::sqrt2;  // of the seed and of another point
    std::size_t fitted = kQuadraticTerms;
    for (std::size_t m = 0; m < members_.size(); ++m) {
      if (members_.size() >= 2 * fitted) {
        fitted = members_.size();
        plane = plane_through(points_, members_);
        deviations = 1;
      }
      for (std::size_t k = 1; k < kSpacingNeighbours; ++k) {
        const std::uint32_t j = near_[members_[m] * kSpacingNeighbours + k];
        if (tried_[j] == round_ || is_taken(j) || !is_within(plane, deviations, j)) continue;
        const bool is_along = deviations == 1 && std::abs(vector::dot(plane.normal, normals_[j])) >= kSamePatch;
        if (!is_along && !is_parallel(plane, j)) continue;
        tried_[j] = round_;
        members_.push_back(j);
      }
    }
    return members_;
  }

 private:
  [[nodiscard]] bool is_parallel(const FacetPlane& plane, std::uint32_t j) const {
    return proven_[j] != 0 && 1 - std::abs(vector::dot(plane.normal, normals_[j])) <= turned_by_;
  }
  [[nodiscard]] bool is_within(const FacetPlane& plane, double deviations, std::uint32_t j) const {
    return std::abs(plane.height(points_[j])) <= std::max(kExactScatter * spacing_[j], kSigmas * deviations * scatter_);
  }

  const std::vector<Vec3>& points_;
  const std::vector<double>& spacing_;
  const std::vector<std::uint32_t>& near_;
  const std::vector<std::uint8_t>& proven_;
  const std::vector<Vec3>& normals_;
  const double scatter_;
  // 1 - cosine of the angle between normals of one facet: their error, or what a bend of a spacing's radius, the least that a sample shows,
  // turns by where it leaves its plane.
  const double turned_by_;
  static constexpr std::uint32_t kTaken = UINT32_MAX;
  std::vector<std::uint32_t> tried_;  // the last round in which a point joined, or kTaken
  std::uint32_t round_ = 0;
  std::vector<std::uint32_t> members_;
};

}  // namespace

Facets find_facets(const PointSet& set, const std::vector<std::uint8_t>& proven, const std::vector<Vec3>& normals, double scatter,
                   const std::vector<std::uint8_t>& wanted) {
  Facets facets;
  facets.of.assign(set.size(), Facets::kNone);
  if (set.size() < kSpacingNeighbours) return facets;
  FacetGrowth growth(set, proven, normals, scatter);
  for (const std::uint32_t seed : growth.seeds()) {
    if (growth.is_taken(seed)) continue;
    const std::vector<std::uint32_t>& members = growth.from(seed);
    if (members.size() < kQuadraticTerms) continue;
    growth.take(members);
    if (!wanted.empty() && std::none_of(members.begin(), members.end(), [&](std::uint32_t i) { return wanted[i] != 0; })) continue;
    for (const std::uint32_t i : members) facets.of[i] = static_cast<std::uint32_t>(facets.count);
    facets.planes.push_back(plane_through(set.points(), members));
    ++facets.count;
  }
  return facets;
}

double minority_share(const Facets& facets, const std::vector<Vec3>& normals, const std::vector<std::uint8_t>& wanted) {
  const std::vector<std::uint8_t> minority = in_minority(facets, normals);
  return share_of_wanted(wanted, normals.size(), [&](std::size_t i) { return minority[i] != 0; });
}

void turn_single_points(const PointSet& set, const Facets& facets, const std::vector<std::uint8_t>& wanted, std::vector<Vec3>& normals) {
  const std::vector<std::uint8_t> minority = in_minority(facets, normals);
  const std::size_t count = set.near_count();
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (minority[i] == 0 || (!wanted.empty() && wanted[i] == 0)) continue;
    std::size_t same = 0, all = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t j = set.near()[i * count + k];
      if (facets.of[j] != facets.of[i]) continue;
      ++all;
      same += minority[j];
    }
    if (2 * same < all) normals[i] = vector::scale(normals[i], -1);
  }
}

void choose_facet_sides(const PointSet& set, const Settings& settings, const Facets& facets, std::vector<Vec3>& eta,
                        std::vector<Vec3>& normals, Stages& stages) {
  const std::vector<double>& spacing = set.smoothed_spacing();
  const std::vector<double> areas = point_areas(settings, spacing);
  const std::vector<Vec3> turned = turned_to_first(facets, normals);
  const std::vector<std::uint8_t> unsure = unsure_facets(facets, areas, turned, normals, eta);
  const std::vector<std::uint32_t> some = around_unsure(set.points(), spacing, unsure);
  const auto set_areas = [&] {
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (facets.of[i] != Facets::kNone) eta[i] = vector::scale(normals[i], areas[i]);
    }
  };
  set_areas();
  const Facets here{values_at(some, facets.of), facets.count, {}};
  const Subspace subspace(here, values_at(some, areas), values_at(some, turned));
  const std::vector<Vec3> start = subspace.project(values_at(some, eta));
  for (std::size_t k = 0; k < some.size(); ++k) eta[some[k]] = start[k];
  const auto with_system = [&](const std::vector<Vec3>& points, const std::vector<double>& h, const auto& work) {
    FastSum sum(points, local_widths(settings.polish.epsilon, settings, h), settings.first_sums, stages.cancel());
    EnergySystem system(sum, 0, settings.polish.winding_weight);
    return work(system);
  };
  PartResidual right = with_system(set.points(), spacing, [&](EnergySystem& all) { return residual_at(some, all, eta); });
  right.residual = subspace.project(std::move(right.residual));
  const std::vector<Vec3> points = values_at(some, set.points());
  const std::vector<Vec3> change = with_system(points, values_at(some, spacing), [&](EnergySystem& free) {
    OnFacets part(free, subspace);
    const auto still_going = [&stages](int, int, double) { stages.still_going(); };
    return solve_for_part(part, right, {kMoreSteps}, settings.doubtful_tolerance, still_going).eta;
  });
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t i = some[k];
    if (unsure[i] == 0) continue;
    normals[i] = vector::scale(turned[i], vector::dot(vector::add(start[k], change[k]), turned[i]) < 0 ? -1 : 1);
  }
  set_areas();
}

}  // namespace g3r
