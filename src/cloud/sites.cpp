#include "cloud/sites.h"

#include "base/vector.h"
#include "cloud/disk_sample.h"
#include "cloud/morton.h"
#include "cloud/site_planes.h"
#include "cpu/parallel.h"

#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace g3r {
namespace {

// Sites at the centroids of the points nearest to each of `seeds`, in canonical order.
void gather(const std::vector<Vec3>& points, const std::vector<Vec3>& seeds, const std::atomic<bool>* cancel, Sites& sites) {
  std::vector<std::uint32_t> nearest(points.size());
  const Neighbours tree(seeds);
  parallel::for_blocks(
      points.size(), parallel::kSmallBlock,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          double squared = HUGE_VAL;
          nearest[i] = tree.nearest(points[i], squared, 0);
        }
      },
      cancel);
  std::vector<Vec3> centroids(seeds.size(), Vec3{0, 0, 0});
  std::vector<double> count(seeds.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    centroids[nearest[i]] = vector::add(centroids[nearest[i]], points[i]);
    ++count[nearest[i]];
  }
  for (std::size_t s = 0; s < seeds.size(); ++s) centroids[s] = vector::scale(centroids[s], 1 / count[s]);
  const std::vector<std::uint32_t> order = morton_order(centroids);
  std::vector<std::uint32_t> rank(seeds.size());
  std::vector<Vec3> sorted(seeds.size());
  for (std::uint32_t s = 0; s < seeds.size(); ++s) {
    rank[order[s]] = s;
    sorted[s] = centroids[order[s]];
  }
  sites.set = PointSet(std::move(sorted));
  sites.site_of.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sites.site_of[i] = rank[nearest[i]];
}

// The planes of sites, through points of the set within reach, or through the nearest where all of these are the sites.
void fit_planes(const PointSet& set, double distance, const std::atomic<bool>* cancel, Sites& sites) {
  const std::size_t count = sites.size();
  sites.axis.resize(count);
  sites.flatness.resize(count);
  sites.breadth.resize(count);
  if (distance > 0) {
    static_cast<void>(set.tree());  // made before the loop
  } else {
    static_cast<void>(set.near());
  }
  parallel::for_blocks(
      count, parallel::kSmallBlock,
      [&](std::size_t begin, std::size_t end) {
        SitePlanes planes(set, distance);
        for (std::size_t s = begin; s < end; ++s) {
          const SitePlane plane = distance > 0 ? planes.at(sites.points()[s]) : planes.at_point(s);
          sites.axis[s] = plane.normal;
          sites.flatness[s] = plane.flatness;
          sites.breadth[s] = plane.breadth;
        }
      },
      cancel);
}

}  // namespace

Sites place_sites(const PointSet& set, double distance, const std::atomic<bool>* cancel) {
  const std::vector<Vec3>& points = set.points();
  Sites sites;
  sites.distance = distance;
  if (distance > 0) {
    gather(points, disk_sample(points, distance), cancel, sites);
  } else {
    sites.set = set;
    sites.site_of.resize(points.size());
    std::iota(sites.site_of.begin(), sites.site_of.end(), std::uint32_t{0});
  }
  fit_planes(set, distance, cancel, sites);
  return sites;
}

Sites place_sites(const PointSet& set, const std::vector<double>& distance, const std::atomic<bool>* cancel) {
  const std::vector<Vec3>& points = set.points();
  std::map<double, std::vector<Vec3>> alike;
  for (std::size_t i = 0; i < points.size(); ++i) alike[distance[i]].push_back(points[i]);
  std::vector<Vec3> seeds;
  for (const auto& [apart, some] : alike) {
    const std::vector<Vec3> taken = apart > 0 ? disk_sample(some, apart) : some;
    seeds.insert(seeds.end(), taken.begin(), taken.end());
  }
  Sites sites;
  gather(points, seeds, cancel, sites);
  fit_planes(sites.set, 0, cancel, sites);
  return sites;
}

double Sites::side(std::size_t site) const {
  const double around = set.smoothed_spacing()[site];
  // As far from the others as a site of the next scale is a stray, whose area would be that of its emptiness.
  return spacing()[site] > kFirstDistance * around ? around : spacing()[site];
}

}  // namespace g3r
