#include "orient/agreement.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "orient/confidence.h"
#include "orient/crowded.h"
#include "solve/refine.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace g3r {
namespace {

using vector::dot;

// The nearest sites that a site is connected with: 12 lead from a thin wall to the next under noise.
constexpr std::size_t kAdjacent = 10;

// What is far, of sites `reach` apart: twice what separates walls. Longer edges cross gaps, and where sides do not agree a field so wide
// sees what is around; wider ones turn the rims of small surfaces.
double far_from(double reach) { return kLevelRatio * kResolved * reach; }

double reach_of(const Sites& sites, std::uint32_t a, std::uint32_t b) {
  return sites.distance > 0 ? sites.distance : (sites.spacing()[a] + sites.spacing()[b]) / 2;
}

SignEdge edge_of(const Sites& sites, std::uint32_t a, std::uint32_t b) {
  const Vec3 d = vector::subtract(sites.points()[b], sites.points()[a]);
  const double squared = dot(d, d);
  const double reach = reach_of(sites, a, b);
  if (squared > far_from(reach) * far_from(reach)) return {a, a, 0};
  const double mirrored = dot(sites.axis[a], sites.axis[b]) -
                          2 * dot(sites.axis[a], d) * dot(sites.axis[b], d) / std::max(squared, std::numeric_limits<double>::min());
  // Sites whose surroundings are a ball still follow their neighbours.
  const double flat = std::max(kRidge, 1 - sites.flatness[a]) * std::max(kRidge, 1 - sites.flatness[b]);
  return {a, b, flat * std::exp(-squared / (2 * kWeightReach * kWeightReach * reach * reach)) * mirrored};
}

std::vector<Vec3> areas_of(const Sites& sites, std::vector<Vec3> normals) {
  for (std::size_t s = 0; s < normals.size(); ++s) normals[s] = vector::scale(normals[s], sites.spacing()[s] * sites.spacing()[s]);
  return normals;
}

Sites coarser_than(const PointSet& set, const Sites& sites) {
  return place_sites(set, std::max(kFirstDistance * set.spacing(), kLevelRatio * sites.distance));
}

// Of all points, from normals of the sites.
std::vector<Vec3> at_points(const PointSet& set, const Sites& sites, std::vector<Vec3> normals, const SumPlan& sums,
                            const std::atomic<bool>* cancel) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = sites.set.spacing();
  const auto widths = [&](double width) { return narrowed(width * spacing, sites.set.smoothed_spacing(), spacing); };
  FastSum wide(sites.points(), widths(kResolved), sums, cancel);
  for (int turn = 0; turn < kMostRounds; ++turn) normals = refine_normals(wide, areas_of(sites, normals)).normals;
  // Directions from a narrower field, where its side is the same.
  const FastSum field(wide, widths(kBetweenSites));
  std::vector<Vec3> sided(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sided[i] = normals[sites.site_of[i]];
  std::vector<Vec3> narrow = unit_normals(field.winding_gradient_at(areas_of(sites, normals), points, cancel), sided).normals;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (dot(narrow[i], sided[i]) > 0) sided[i] = narrow[i];
  }
  return sided;
}

// Of all points, from the signs that the sites of one scale agree on.
std::vector<Vec3> by_agreement(const PointSet& set, const Sites& sites, const SumPlan& sums, const std::atomic<bool>* cancel) {
  const std::size_t count = sites.size();
  std::vector<Vec3> normals(count);
  const Signs signs = agree_on_signs(count, adjacent_sites(sites));  // 110 bytes a site, made again rather than kept
  for (std::size_t s = 0; s < count; ++s) normals[s] = vector::scale(sites.axis[s], signs.sign[s]);
  return at_points(set, sites, std::move(normals), sums, cancel);
}

}  // namespace

std::vector<SignEdge> adjacent_sites(const Sites& sites) {
  const std::size_t count = sites.size();
  const std::vector<std::uint32_t>& near = sites.set.near();
  const std::size_t stride = sites.set.near_count();
  const std::size_t adjacent = std::min(kAdjacent + 1, stride);
  std::vector<SignEdge> edges;
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < adjacent; ++k) {
      const std::uint32_t j = near[i * stride + k];
      const auto first = near.begin() + static_cast<std::ptrdiff_t>(j * stride);
      const auto last = first + static_cast<std::ptrdiff_t>(adjacent);
      if (j == i || (j < i && std::find(first, last, i) != last)) continue;
      const SignEdge edge = edge_of(sites, i, j);
      if (edge.a != edge.b) edges.push_back(edge);
    }
  }
  return edges;
}

std::vector<Vec3> at_sites(const Sites& sites, const std::vector<Vec3>& normals) {
  std::vector<Vec3> mean(sites.size(), Vec3{0, 0, 0});
  for (std::size_t i = 0; i < normals.size(); ++i) mean[sites.site_of[i]] = vector::add(mean[sites.site_of[i]], normals[i]);
  for (std::size_t s = 0; s < mean.size(); ++s) {
    mean[s] = vector::normalised(mean[s]);
    if (dot(mean[s], mean[s]) == 0) mean[s] = sites.axis[s];
  }
  return mean;
}

std::vector<Hold> held_by_neighbours(const Sites& sites, const std::vector<Vec3>& normals) {
  std::vector<SignEdge> edges = adjacent_sites(sites);
  for (SignEdge& edge : edges) {
    const bool is_turned = (dot(normals[edge.a], sites.axis[edge.a]) < 0) != (dot(normals[edge.b], sites.axis[edge.b]) < 0);
    if (is_turned) edge.weight = -edge.weight;
  }
  return held_together(sites.size(), std::move(edges));
}

std::vector<std::vector<Vec3>> sides_by_agreement(const PointSet& set, const Sites& finest, const SumPlan& sums,
                                                  const std::atomic<bool>* cancel) {
  std::vector<std::vector<Vec3>> all{by_agreement(set, finest, sums, cancel)};
  Sites sites = coarser_than(set, finest);
  // The rings of a spinning scanner and roofs need the coarsest.
  while (all.size() < kScales && sites.size() >= kFewestSites) {
    std::vector<Vec3> normals = by_agreement(set, sites, sums, cancel);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      normals[i] = vector::scale(all.front()[i], dot(all.front()[i], normals[i]) < 0 ? -1 : 1);
    }
    all.push_back(std::move(normals));
    sites = coarser_than(set, sites);
  }
  return all;
}

std::vector<Vec3> sides_as_known(const PointSet& set, const Sites& sites, const std::vector<Vec3>& known, const SumPlan& sums,
                                 const std::atomic<bool>* cancel) {
  std::vector<Vec3> normals = sites.axis;
  const std::vector<Vec3> sides = at_sites(sites, known);
  for (std::size_t s = 0; s < normals.size(); ++s) normals[s] = vector::scale(normals[s], dot(normals[s], sides[s]) < 0 ? -1 : 1);
  return at_points(set, sites, std::move(normals), sums, cancel);
}

std::vector<Vec3> seen_from_afar(const PointSet& set, const Sites& sites, const std::vector<Vec3>& normals, const SumPlan& sums,
                                 const std::atomic<bool>* cancel) {
  const double spacing = sites.set.spacing();
  const FastSum field(sites.points(), narrowed(far_from(spacing), sites.set.smoothed_spacing(), spacing), sums, cancel);
  return unit_normals(field.winding_gradient_at(areas_of(sites, at_sites(sites, normals)), set.points(), cancel), normals).normals;
}

}  // namespace g3r
