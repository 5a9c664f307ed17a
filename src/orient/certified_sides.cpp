#include "orient/certified_sides.h"

#include "base/vector.h"
#include "cloud/sites.h"
#include "cloud/spacing.h"
#include "orient/agreement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace g3r {
namespace {

using vector::dot;

}  // namespace

std::vector<double> concentration(const Sites& sites, const std::vector<Vec3>& normals) {
  std::vector<Vec3> sum(sites.size(), Vec3{0, 0, 0});
  std::vector<double> count(sites.size(), 0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    sum[sites.site_of[i]] = vector::add(sum[sites.site_of[i]], normals[i]);
    ++count[sites.site_of[i]];
  }
  const std::vector<std::uint32_t>& near = sites.set.near();
  const std::size_t stride = sites.set.near_count();
  std::vector<double> out(sites.size());
  for (std::size_t s = 0; s < sites.size(); ++s) {
    Vec3 around{};
    double all = 0;
    for (std::size_t k = 0; k < std::min(kClosest + 1, stride); ++k) {
      around = vector::add(around, sum[near[s * stride + k]]);
      all += count[near[s * stride + k]];
    }
    out[s] = std::sqrt(dot(around, around)) / all;
  }
  return out;
}

std::vector<float> certified_sides(const SiteParts& parts, const Certificate& certificate, const std::vector<Vec3>& normals, bool exact) {
  const std::vector<double> unrest = parts.means(certificate.unrest);
  const std::vector<Vec3> mean = at_sites(parts.sites(), normals);
  const std::vector<double> one_way = exact ? std::vector<double>{} : concentration(parts.sites(), normals);
  const bool is_thinned = parts.thinned_for_noise();
  std::vector<float> out(normals.size(), 0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t s = parts.sites().site_of[i];
    const std::uint32_t part = parts.of_point(i);
    if ((exact && parts.members(part).size() < kFewestSites) || dot(normals[i], mean[s]) <= 0) continue;
    const double jump = is_thinned ? 1 - certificate.scaled_defect[s] : certificate.jump[s];
    const double restless = std::min(1.0, unrest[part] / unrest_of_open(is_thinned));
    out[i] = static_cast<float>((exact ? 1 : one_way[s]) * std::clamp(jump, 0.0, 1.0) * (1 - restless * restless));
  }
  return out;
}

std::vector<float> certified_sides(const PointSet& set, double noise, const SumPlan& sums, const std::vector<Vec3>& normals,
                                   const std::atomic<bool>* cancel) {
  if (set.size() < kFewestSites) return std::vector<float>(set.size(), 0);
  const SiteParts parts(set, noise, sums, cancel);
  return certified_sides(parts, parts.test(normals), normals, noise == 0);
}

}  // namespace g3r
