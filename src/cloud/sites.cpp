#include "cloud/sites.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/wires.h"
#include "cpu/parallel.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace g3r {
namespace {

// Distances of sites: the plane of a site is fitted to its neighbours and theirs, about 20 sites.
constexpr double kReach = 2.5;

// Cells of the size of the distance: whoever is nearer than that lies in the same or an adjacent one.
class Grid {
 public:
  explicit Grid(double cell) : cell_(cell) {}

  bool add_if_alone(const std::vector<Vec3>& points, std::uint32_t i) {
    const auto is_near = [&](std::uint32_t j) {
      const Vec3 d = vector::subtract(points[i], points[j]);
      return vector::dot(d, d) < cell_ * cell_;
    };
    if (!taken_.empty() && is_near(last_)) return false;  // as half of them are, in Morton order
    std::array<std::int64_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<std::int64_t>(std::floor(points[i][a] / cell_));
    for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x) {
      for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y) {
        for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z) {
          const auto found = taken_.find(key({x, y, z}));
          if (found == taken_.end()) continue;
          if (std::any_of(found->second.begin(), found->second.end(), is_near)) return false;
        }
      }
    }
    taken_[key(at)].push_back(i);
    last_ = i;
    return true;
  }

 private:
  // Cells whose keys meet cost time only.
  static std::uint64_t key(const std::array<std::int64_t, 3>& at) {
    std::uint64_t key = 0;
    for (const std::int64_t i : at) key = (key << kGridBits) ^ static_cast<std::uint64_t>(i);
    return key;
  }

  double cell_;
  std::uint32_t last_ = 0;  // taken
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> taken_;
};

std::vector<Vec3> taken_points(const std::vector<Vec3>& points, double distance) {
  std::vector<Vec3> taken;
  Grid grid(distance);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (grid.add_if_alone(points, i)) taken.push_back(points[i]);
  }
  return taken;
}

struct Plane {
  Vec3 normal;
  double flatness, breadth;
};

// The plane through n points around `centre`, weights 1 - r^2 / R^2, with R the radius that one more would be at: that of the farthest
// times sqrt(1 + 1 / n).
Plane fit_plane_at(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, const Vec3& centre) {
  using Eigen::Vector3d;
  const auto from_centre = [&](std::uint32_t j) {
    const Vec3 d = vector::subtract(points[j], centre);
    return Vector3d(d[0], d[1], d[2]);
  };
  double reach = 0;
  for (const std::uint32_t j : index) reach = std::max(reach, from_centre(j).squaredNorm());
  reach *= 1 + 1 / static_cast<double>(index.size());
  Vector3d mean = Vector3d::Zero();
  double total = 0;
  for (const std::uint32_t j : index) {
    const double weight = 1 - from_centre(j).squaredNorm() / reach;
    mean += weight * from_centre(j);
    total += weight;
  }
  mean /= total;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::uint32_t j : index) {
    const Vector3d d = from_centre(j) - mean;
    spread += (1 - from_centre(j).squaredNorm() / reach) * d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(spread / reach);
  const Vector3d normal = eigen.eigenvectors().col(0);
  const Vector3d value = eigen.eigenvalues().cwiseMax(0);
  return {{normal[0], normal[1], normal[2]},
          value[1] > 0 ? std::sqrt(value[0] / value[1]) : 1,
          value[2] > 0 ? std::sqrt(value[1] / value[2]) : 0};
}

// The plane through the surroundings of a place.
class Planes {
 public:
  Planes(const PointSet& set, double distance) : set_(set), reach_(kReach * distance) {}

  Plane at(const Vec3& centre) {
    index_.clear();
    if (reach_ > 0) set_.tree().within(centre, reach_, index_);
    return through_found(set_, centre);
  }

  // The same, but more than kPlaces points are too many: the first of the sets where so many are not stands for them.
  Plane through_some_at(const Vec3& centre, const std::vector<PointSet>& thinned) {
    if (reach_ == 0) return at(centre);
    const PointSet* set = &set_;
    set->tree().within(centre, reach_, index_, kPlaces);
    for (auto next = thinned.begin(); index_.size() > kPlaces && next != thinned.end(); ++next) {
      set = &*next;
      set->tree().within(centre, reach_, index_, kPlaces);
    }
    return through_found(*set, centre);
  }

  // Of a point and its nearest, where every point is a site.
  Plane at_point(std::size_t i) {
    const auto first = set_.near().begin() + static_cast<std::ptrdiff_t>(i * set_.near_count());
    index_.assign(first, first + static_cast<std::ptrdiff_t>(std::min(kPatchNeighbours, set_.near_count())));
    std::sort(index_.begin(), index_.end());
    return fit_plane_at(set_.points(), index_, set_.points()[i]);
  }

 private:
  Plane through_found(const PointSet& set, const Vec3& centre) {
    if (index_.size() < kPatchNeighbours) set.tree().nearest(centre, kPatchNeighbours, index_, squared_);
    std::sort(index_.begin(), index_.end());
    return fit_plane_at(set.points(), index_, centre);
  }

  const PointSet& set_;
  double reach_;
  std::vector<std::uint32_t> index_;
  std::vector<double> squared_;
};

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

// Whether most of the points near point i lie along a line: that have a plane of less than this breadth.
template <class Breadth>
bool is_in_lines(const PointSet& set, std::size_t i, const Breadth& breadth) {
  const std::size_t stride = set.near_count();
  const auto first = set.near().begin() + static_cast<std::ptrdiff_t>(i * stride);
  const auto narrow =
      std::count_if(first, first + static_cast<std::ptrdiff_t>(stride), [&](std::uint32_t j) { return breadth(j) < kClearlyLess; });
  return 2 * static_cast<std::size_t>(narrow) > stride;
}

// Whether more of some 500 points do than by chance.
bool has_lines(const PointSet& set) {
  const std::size_t step = std::max<std::size_t>(1, set.size() / kFewPlaces);
  std::vector<std::uint8_t> in_lines((set.size() + step - 1) / step);
  static_cast<void>(set.near());  // made before the loop
  parallel::for_blocks(in_lines.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    Planes planes(set, 0);
    const auto breadth = [&](std::uint32_t j) { return planes.at_point(j).breadth; };
    for (std::size_t k = begin; k < end; ++k) in_lines[k] = is_in_lines(set, k * step, breadth) ? 1 : 0;
  });
  const auto count = std::count(in_lines.begin(), in_lines.end(), std::uint8_t{1});
  return static_cast<double>(count) > kFalseAlarms * static_cast<double>(in_lines.size());
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
        Planes planes(set, distance);
        for (std::size_t s = begin; s < end; ++s) {
          const Plane plane = distance > 0 ? planes.at(sites.points()[s]) : planes.at_point(s);
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
    gather(points, taken_points(points, distance), cancel, sites);
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
    const std::vector<Vec3> taken = apart > 0 ? taken_points(some, apart) : some;
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

double surface_distance(const PointSet& set, const std::atomic<bool>* cancel) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  std::vector<PointSet> thinned;
  const double length = static_cast<double>(points.size()) * spacing;  // of the lines that they are at most
  for (double distance = 0; distance * static_cast<double>(kFewestSites) < length;
       distance = std::max(kFirstDistance * spacing, kLevelRatio * distance)) {
    const std::size_t sites = distance > 0 ? static_cast<std::size_t>(length / distance) : points.size();
    const std::size_t step = std::max<std::size_t>(1, points.size() / std::min(kPlaces, sites));
    std::vector<double> breadth((points.size() + step - 1) / step);
    if (distance > 0 && thinned.empty()) thinned = thinned_sets(set);
    parallel::for_blocks(
        breadth.size(), parallel::kSmallBlock,
        [&](std::size_t begin, std::size_t end) {
          Planes planes(set, distance);
          for (std::size_t k = begin; k < end; ++k) breadth[k] = planes.through_some_at(points[k * step], thinned).breadth;
        },
        cancel);
    if (median(breadth) < kClearlyLess) continue;
    return distance == 0 || taken_points(points, distance).size() >= kFewestSites ? distance : 0;
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
  std::vector<std::uint32_t> in_lines(count);  // that are, seen from sites as far apart as now
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
