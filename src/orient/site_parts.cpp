#include "orient/site_parts.h"

#include "base/disjoint_sets.h"
#include "base/vector.h"
#include "orient/agreement.h"
#include "orient/crowded.h"
#include "orient/settings.h"
#include "solve/part_system.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r {

void make_room_for_sums(const PointSet& set) {
  if (set.size() > kMostSites) set.release_neighbours();
}

double site_distance(std::size_t points, double spacing, double noise) {
  const double all = std::sqrt(static_cast<double>(points) / static_cast<double>(kMostSites));
  const double least = std::max(kResolved * noise, all > 1 ? kFirstDistance * all * spacing : 0);
  return least < kFirstDistance / kLevelRatio * spacing ? 0 : std::max(kFirstDistance * spacing, least);
}

SiteParts::SiteParts(const PointSet& set, double noise, const SumPlan& sums, const std::atomic<bool>* cancel)
    : set_(set),
      sums_(sums),
      cancel_(cancel),
      sites_(place_sites(set, site_distance(set.size(), set.spacing(), noise))),
      thinned_for_noise_(site_distance(0, set.spacing(), noise) > 0) {
  DisjointSets parts(sites_.size());
  for (const SignEdge& edge : adjacent_sites(sites_)) parts.join(edge.a, edge.b);
  std::vector<std::uint32_t> number(sites_.size(), 0);
  for (std::uint32_t s = 0; s < sites_.size(); ++s) {
    const std::size_t first = parts.find(s);  // the smallest site of its part
    if (first == s) {
      number[s] = static_cast<std::uint32_t>(members_.size());
      members_.emplace_back();
    }
    part_.push_back(number[first]);
    members_[part_.back()].push_back(s);
  }
  for (std::size_t s = 0; s < sites_.size(); ++s) {
    reach_.push_back(std::sqrt(static_cast<double>(members_[part_[s]].size())) / 2 * sites_.spacing()[s]);
  }
}

double mean_over(const std::vector<std::uint32_t>& sites, const std::vector<double>& value) {
  double sum = 0;
  double count = 0;
  for (const std::uint32_t s : sites) {
    if (value[s] < 0) continue;
    sum += value[s];
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

std::vector<double> SiteParts::means(const std::vector<double>& value) const {
  std::vector<double> mean;
  for (const std::vector<std::uint32_t>& part : members_) mean.push_back(mean_over(part, value));
  return mean;
}

Certificate SiteParts::test(const std::vector<Vec3>& normals) const {
  return certify(sites_, at_sites(sites_, normals), reach_, sums_, cancel_);
}

JumpDefects SiteParts::jump_defects(const std::vector<std::vector<Vec3>>& hypotheses) const {
  std::vector<std::vector<Vec3>> normals;
  normals.reserve(hypotheses.size());
  for (const std::vector<Vec3>& hypothesis : hypotheses) normals.push_back(at_sites(sites_, hypothesis));
  return g3r::jump_defects(sites_, std::move(normals), sums_, cancel_);
}

double SiteParts::enclosure(const std::vector<std::uint32_t>& some, const std::vector<Vec3>& normals) const {
  std::vector<Vec3> points;
  std::vector<Vec3> eta;
  const double spacing = sites_.set.spacing();
  const std::vector<double> around = values_at(some, sites_.set.smoothed_spacing());
  for (const std::uint32_t s : some) {
    points.push_back(sites_.points()[s]);
    eta.push_back(vector::scale(normals[s], sites_.side(s) * sites_.side(s)));
  }
  FastSum field(points, narrowed(kBetweenSites * spacing, around, spacing), sum_plan(kContinuedAccuracy, points.size()), cancel_);
  double sum = 0;
  for (const double w : field.winding(eta)) sum += w;
  return 2 * sum / static_cast<double>(points.size());
}

}  // namespace g3r
