#include "cloud/surface_distance.h"

#include "base/median.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/disk_sample.h"
#include "cloud/site_planes.h"
#include "cloud/sites.h"
#include "cloud/some_places.h"
#include "cloud/wires.h"
#include "cpu/parallel.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

namespace g3r {
namespace {

// Every 4th, 16th, ... of the points in canonical order, which are as dense everywhere for their number, with their trees, down to kPlaces.
std::vector<PointSet> thinned_sets(const PointSet& set) {
  std::vector<PointSet> sets;
  for (const PointSet* finer = &set; finer->size() > kPlaces; finer = &sets.back()) {
    std::vector<Vec3> some;
    for (std::size_t i = 0; i < finer->size(); i += kTwiceAsFar) some.push_back(finer->points()[i]);
    sets.emplace_back(std::move(some));
    static_cast<void>(sets.back().tree());
  }
  return sets;
}

// Whether point i is in a line: most of the points near it have a plane that is clearly longer than broad. `breadth(j)`: of the plane at j.
template <class Breadth>
bool is_in_lines(const PointSet& set, std::size_t i, const Breadth& breadth) {
  const std::size_t stride = set.near_count();
  const auto first = set.near().begin() + static_cast<std::ptrdiff_t>(i * stride);
  const auto narrow =
      std::count_if(first, first + static_cast<std::ptrdiff_t>(stride), [&](std::uint32_t j) { return breadth(j) < kClearlyLess; });
  return is_majority(static_cast<double>(narrow), static_cast<double>(stride));
}

// Whether more of the points are in lines than by chance, by some 500 of them.
bool has_lines(const PointSet& set) {
  const SomePlaces some = SomePlaces::at_least(kFewPlaces, set.size());
  std::vector<std::uint8_t> in_lines(some.size());
  static_cast<void>(set.near());  // made before the loop
  parallel::for_blocks(in_lines.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    SitePlanes planes(set, 0);
    const auto breadth = [&](std::uint32_t j) { return planes.at_point(j).breadth; };
    for (std::size_t k = begin; k < end; ++k) in_lines[k] = is_in_lines(set, some[k], breadth) ? 1 : 0;
  });
  const auto count = std::count(in_lines.begin(), in_lines.end(), std::uint8_t{1});
  return static_cast<double>(count) > kFalseAlarms * static_cast<double>(in_lines.size());
}

}  // namespace

double surface_distance(const PointSet& set, const std::atomic<bool>* cancel) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  std::vector<PointSet> thinned;
  const double length = static_cast<double>(points.size()) * spacing;  // of the lines that they are at most
  for (double distance = 0; distance * static_cast<double>(kFewestSites) < length;
       distance = std::max(kFirstDistance * spacing, kLevelRatio * distance)) {
    const std::size_t sites = distance > 0 ? static_cast<std::size_t>(length / distance) : points.size();
    const SomePlaces some = SomePlaces::at_least(std::min(kPlaces, sites), points.size());
    std::vector<double> breadth(some.size());
    if (distance > 0 && thinned.empty()) thinned = thinned_sets(set);
    parallel::for_blocks(
        breadth.size(), parallel::kSmallBlock,
        [&](std::size_t begin, std::size_t end) {
          SitePlanes planes(set, distance);
          for (std::size_t k = begin; k < end; ++k) breadth[k] = planes.through_some_at(points[some[k]], thinned).breadth;
        },
        cancel);
    if (median(breadth) < kClearlyLess) continue;
    return distance == 0 || disk_sample(points, distance).size() >= kFewestSites ? distance : 0;
  }
  return 0;
}

std::vector<double> surface_distances(const PointSet& set, const std::atomic<bool>* cancel) {
  const std::size_t count = set.size();
  const double distance_of_all = surface_distance(set, cancel);
  if (distance_of_all == 0 && !has_lines(set)) return {};
  if (are_wires(set)) return {};
  if (distance_of_all > 0) return std::vector<double>(count, distance_of_all);
  const double first = kFirstDistance * set.spacing();
  std::vector<double> out(count, 0);
  std::vector<std::uint32_t> in_lines(count);  // points that are in lines, at the distance of sites that is looked at
  std::iota(in_lines.begin(), in_lines.end(), std::uint32_t{0});
  for (double distance = 0; in_lines.size() >= kFewestSites;) {
    std::vector<Vec3> some;
    some.reserve(in_lines.size());
    for (const std::uint32_t i : in_lines) some.push_back(set.points()[i]);
    const Sites sites = place_sites(distance > 0 ? PointSet(std::move(some)) : set, distance, cancel);
    if (sites.size() < kFewestSites) break;
    const double next = std::max(first, kLevelRatio * distance);
    std::vector<std::uint8_t> are_lines(sites.size());
    for (std::size_t s = 0; s < sites.size(); ++s) {
      are_lines[s] = is_in_lines(sites.set, s, [&](std::uint32_t j) { return sites.breadth[j]; }) ? 1 : 0;
    }
    std::vector<std::uint32_t> still;
    for (std::size_t k = 0; k < in_lines.size(); ++k) {
      if (are_lines[sites.site_of[k]] == 0) continue;
      still.push_back(in_lines[k]);
      if (distance > 0) out[in_lines[k]] = next;  // what is no line at the first scale has points enough
    }
    if (distance == first && static_cast<double>(still.size()) <= kFalseAlarms * static_cast<double>(count)) return {};
    in_lines = std::move(still);
    distance = next;
  }
  return out;
}

}  // namespace g3r
