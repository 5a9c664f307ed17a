#include "cloud/outliers.h"

#include "base/bisect.h"
#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/noise.h"
#include "cloud/some_places.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace g3r {
namespace {

// Points of a noisy layer that are taken for outliers make its noise look small, and by that more of its points look like outliers: both
// are found in turn, while the noise grows, at most so often. Of an uneven noisy ball 4.1, 2.3 and 1.4 % of the points are left out after
// one, two and three rounds; each costs an estimate of the noise.
constexpr int kRounds = 3;
// Slabs are looked for among the 16 nearest of a point and twice as many so often, and half as thick as a share of their reach and twice
// that so often. More neighbours see a surface among more strays, but bends are flat in few; what is flat is seen best in thin slabs, bends
// and noise need thick ones.
constexpr double kThinnest = 0.05;
constexpr std::size_t slab_neighbours(std::size_t scale) { return (kSpacingNeighbours - 1) << scale; }
constexpr double slab_thickness(std::size_t scale) { return kThinnest * static_cast<double>(std::size_t{1} << scale); }

// P(Poisson(mean) < count).
double chance_of_fewer(std::size_t count, double mean) {
  if (mean <= 0) return 1;
  const double most = static_cast<double>(count) - 1;
  double term = std::exp(most * std::log(mean) - mean - std::lgamma(most + 1)), sum = 0;
  for (double k = most; k >= 0; --k) {
    sum += term;
    term *= k / mean;
  }
  return sum;
}

// How far apart points of an even surface are by chance, in spacings by their `count` nearest; `height`: the noise over the reach of these.
struct EvenSurface {
  std::size_t count = kClosest;
  double height = 0;

  // The share that is farther apart than so many times the median: a surface puts a Poisson number of points into a ball, of which the mean
  // goes with its cross-section, and by which the `count`-th point is at the median for a mean of count - 1/3. Mean over heights, in
  // standard deviations, by the midpoint rule, which is exact to rounding for all that is smooth over one of them: high above its layer a
  // ball cuts less out of it.
  [[nodiscard]] double share_beyond(double spacing) const {
    double sum = 0, weights = 0;
    for (double z = 0.5; std::exp(-z * z / 2) > std::numeric_limits<double>::epsilon(); ++z) {
      const double weight = std::exp(-z * z / 2);
      weights += weight;
      sum += weight * chance_of_fewer(count, (static_cast<double>(count) - 1.0 / 3) * (spacing * spacing - z * z * height * height));
      if (height == 0) break;
    }
    return sum / weights;
  }
};

// The least spacing, in medians, that can be an outlier's: of half of the points, kFalseAlarms are as far apart by chance.
double least_spacing() {
  return last_that([](double spacing) { return EvenSurface().share_beyond(spacing) > kFalseAlarms / 2; });
}

// Whether a slab through a point, and two of kClosest spread over a ball, holds more of those around than chance would put there if they
// filled space: an a contrario test (Desolneux, Moisan and Morel, "From Gestalt Theory to Image Analysis", 2008).
class Slabs {
 public:
  Slabs() {
    constexpr double kTests = kScales * kScales * kClosest * (kClosest - 1) / 2;
    for (std::size_t t = 0; t < kScales; ++t) {
      const double share = share_of_ball(slab_thickness(t));
      for (std::size_t n = 0; n <= kMost; ++n) least_[t].push_back(proving_number(n, share, kTests));
    }
  }

  // `near`: the point and its `count` nearest. Those count that have it among as many nearest of their own, to judge by their spacing: all
  // of a surface's, none of a dense patch beside the point, which is flat from afar.
  [[nodiscard]] bool hold(const PointSet& set, const std::uint32_t* near, std::size_t count) const {
    std::array<Vec3, kMost> q;
    std::size_t n = 0;
    double reach = 0;
    for (std::size_t k = 1; k <= count; ++k) {
      q[n] = vector::subtract(set.points()[near[k]], set.points()[*near]);
      reach = vector::dot(q[n], q[n]);
      const double spacing = set.local_spacing()[near[k]];
      if (k < count && reach <= spacing * spacing * static_cast<double>(count) / std::numbers::pi) ++n;
    }
    const std::size_t apart = n / kClosest;
    if (apart == 0) return false;
    for (std::size_t a = 1; a <= kClosest; ++a) {
      for (std::size_t b = 1; b < a; ++b) {
        const Vec3 m = vector::cross(q[a * apart - 1], q[b * apart - 1]);
        const double most = reach * vector::dot(m, m);  // 0 of points in a line, which every slab along it holds
        std::array<std::size_t, kScales> held{};
        for (std::size_t k = 0; k < n; ++k) {
          const double d = vector::dot(q[k], m);
          for (std::size_t t = 0; t < held.size(); ++t) held[t] += d * d <= slab_thickness(t) * slab_thickness(t) * most ? 1 : 0;
        }
        for (std::size_t t = 0; t < held.size(); ++t) {
          if (held[t] >= least_[t][n - 2] + 2) return true;  // the two that it goes through
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::size_t kMost = slab_neighbours(kScales - 1);
  std::array<std::vector<std::size_t>, kScales> least_;
};

// Whether a slab holds point i among its 16, 32 or 64 nearest. `index`, `squared`: room.
bool is_on_slab(const PointSet& set, const Slabs& slabs, std::size_t i, std::vector<std::uint32_t>& index, std::vector<double>& squared) {
  if (slabs.hold(set, set.near().data() + i * set.near_count(), slab_neighbours(0))) return true;
  for (std::size_t scale = 1; scale < kScales; ++scale) {
    set.tree().nearest(set.points()[i], slab_neighbours(scale) + 1, index, squared);
    if (slabs.hold(set, index.data(), slab_neighbours(scale))) return true;
  }
  return false;
}

// Points so far apart as outliers may be and on no slab.
std::vector<std::uint32_t> find_strays(const PointSet& set, const std::vector<double>& local, double typical) {
  const double least = least_spacing() * typical;
  const Slabs slabs;
  std::vector<char> stray(set.size(), 0);
  parallel::for_blocks(set.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) stray[i] = local[i] > least && !is_on_slab(set, slabs, i, index, squared) ? 1 : 0;
  });
  std::vector<std::uint32_t> strays;
  for (std::uint32_t i = 0; i < stray.size(); ++i) {
    if (stray[i] != 0) strays.push_back(i);
  }
  return strays;
}

// As many of the strays, those farthest apart first, as can be taken with kFalseAlarms of them by chance (Benjamini and Hochberg,
// "Controlling the false discovery rate", 1995). `spacing`: theirs, in medians of all `points`.
std::vector<std::uint32_t> choose(const std::vector<std::uint32_t>& strays, const std::vector<double>& spacing, const EvenSurface& surface,
                                  std::size_t points) {
  std::vector<std::pair<double, std::uint32_t>> farthest;
  for (std::size_t k = 0; k < strays.size(); ++k) farthest.emplace_back(-spacing[k], strays[k]);
  std::sort(farthest.begin(), farthest.end());
  std::size_t taken = farthest.size();
  while (taken > 0 &&
         static_cast<double>(points) * surface.share_beyond(-farthest[taken - 1].first) > kFalseAlarms * static_cast<double>(taken))
    --taken;
  std::vector<std::uint32_t> chosen(taken);
  for (std::size_t k = 0; k < taken; ++k) chosen[k] = farthest[k].second;
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

// Spacings of the strays by their `count` nearest, in medians of all.
std::vector<double> wide_spacing(const PointSet& set, const std::vector<std::uint32_t>& strays, const std::vector<double>& relative_spacing,
                                 std::size_t count) {
  const auto measured = [&](std::size_t size, const auto& at) {
    std::vector<double> spacing(size);
    parallel::for_blocks(size, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> index;
      std::vector<double> squared;
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t i = at(k);
        set.tree().nearest(set.points()[i], count + 1, index, squared);
        spacing[k] = std::sqrt(squared.back()) / (relative_spacing.empty() ? 1 : relative_spacing[i]);
      }
    });
    return spacing;
  };
  const std::size_t probes = std::min(kPlaces, set.size());
  const double typical =
      typical_spacing(measured(probes, [&](std::size_t k) { return static_cast<std::size_t>(std::uint64_t{k} * set.size() / probes); }));
  std::vector<double> spacing = measured(strays.size(), [&](std::size_t k) { return std::size_t{strays[k]}; });
  for (double& s : spacing) s /= typical;
  return spacing;
}

// Those of the strays that no noisy layer holds. A ball of 10 standard deviations about a point of a layer, whatever its density, has a
// quarter of its points in one of 5; where they fill space an eighth of them. More than chance would put there prove a layer.
std::vector<std::uint32_t> off_layers(const PointSet& set, const std::vector<std::uint32_t>& strays, double noise) {
  const double inner = kNoiseBreadth * noise, outer = kLevelRatio * inner;
  const double by_chance = 1 / (kLevelRatio * kLevelRatio * kLevelRatio);
  std::vector<std::size_t> proving;  // of so many others, which stand for all
  for (std::size_t n = 0; n <= kFewPlaces; ++n) proving.push_back(proving_number(n, by_chance, 1));
  std::vector<std::uint8_t> is_held(strays.size(), 0);
  parallel::for_blocks(strays.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3& point = set.points()[strays[k]];
      set.tree().within(point, outer, near);
      std::erase(near, strays[k]);
      const SomePlaces some = SomePlaces::at_most(kFewPlaces, near.size());
      std::size_t held = 0;
      for (std::size_t q = 0; q < some.size(); ++q) {
        const Vec3 d = vector::subtract(set.points()[near[some[q]]], point);
        held += vector::dot(d, d) < inner * inner ? 1 : 0;
      }
      is_held[k] = held >= proving[some.size()] ? 1 : 0;
    }
  });
  std::vector<std::uint32_t> off;
  for (std::size_t k = 0; k < strays.size(); ++k) {
    if (is_held[k] == 0) off.push_back(strays[k]);
  }
  return off;
}

PointSet others_than(const PointSet& set, const std::vector<std::uint32_t>& some) {
  std::vector<Vec3> others;
  std::size_t next = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (next < some.size() && some[next] == i) {
      ++next;
    } else {
      others.push_back(set.points()[i]);
    }
  }
  return PointSet(std::move(others));
}

}  // namespace

Outliers find_outliers(const PointSet& set, const std::vector<double>& relative_spacing, std::optional<double> noise) {
  if (set.size() <= slab_neighbours(kScales - 1)) return {{}, noise, {}};
  const std::vector<double> local = spacing_before_thinning(set.local_spacing(), relative_spacing);
  const double typical = typical_spacing(local);
  const std::vector<std::uint32_t> strays = find_strays(set, local, typical);
  std::vector<double> spacing;
  for (const std::uint32_t i : strays) spacing.push_back(local[i] / typical);
  std::vector<std::uint32_t> chosen = choose(strays, spacing, {}, set.size());
  // Which of two halves is the surface is a choice.
  const auto too_many = [&] { return is_majority(static_cast<double>(chosen.size()), static_cast<double>(set.size())); };
  if (chosen.empty() || too_many()) return {{}, noise, {}};
  const bool is_given = noise.has_value();
  PointSet others;
  for (int round = 0; round < kRounds; ++round) {
    if (!is_given) {
      others = others_than(set, chosen);
      const double found = estimate_noise(others);
      if (noise && found <= *noise) break;
      noise = found;
    }
    const double sigma = *noise / (is_given ? set : others).spacing();
    const double held =
        std::numbers::pi * std::pow(kNoiseBreadth * sigma, 2);  // by a ball about any point of a layer, which holds all of it
    if (!(held < static_cast<double>(set.size()))) return {};
    const auto count = static_cast<std::size_t>(held);
    if (count <= kClosest) break;
    const EvenSurface layer{count, sigma * std::sqrt(std::numbers::pi / static_cast<double>(count))};
    const std::vector<std::uint32_t> off = off_layers(set, strays, *noise);
    chosen = choose(off, wide_spacing(set, off, relative_spacing, count), layer, set.size());
    if (too_many()) chosen.clear();
    others = PointSet();
    if (is_given) break;
  }
  return {chosen, noise, others};
}

double share_in_space(const PointSet& set, const std::vector<std::uint32_t>& some) {
  if (set.size() <= slab_neighbours(kScales - 1)) return 0;
  const Slabs slabs;
  const std::size_t places = std::min(kPlaces, some.size());
  std::vector<std::uint8_t> on_slab(places);
  parallel::for_blocks(places, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = some[static_cast<std::size_t>(std::uint64_t{k} * some.size() / places)];
      on_slab[k] = is_on_slab(set, slabs, i, index, squared) ? 1 : 0;
    }
  });
  return static_cast<double>(std::count(on_slab.begin(), on_slab.end(), std::uint8_t{0})) / static_cast<double>(places);
}

std::vector<Vec3> remove_points(CanonicalCloud& cloud, const std::vector<std::uint32_t>& indices, const PointSet& others) {
  if (indices.empty()) return {};
  const std::size_t staying = cloud.size() - indices.size();
  std::vector<Vec3> removed;
  std::vector<std::uint32_t> removed_multiplicity;
  std::vector<std::uint32_t> renumbered(cloud.size());
  std::vector<Vec3> points;
  points.reserve(staying);
  for (std::uint32_t i = 0; i < renumbered.size(); ++i) {
    if (removed.size() < indices.size() && indices[removed.size()] == i) {
      renumbered[i] = static_cast<std::uint32_t>(staying + removed.size());
      removed.push_back(cloud.points()[i]);
      removed_multiplicity.push_back(cloud.multiplicity[i]);
      continue;
    }
    renumbered[i] = static_cast<std::uint32_t>(points.size());
    cloud.multiplicity[points.size()] = cloud.multiplicity[i];
    points.push_back(cloud.points()[i]);
  }
  cloud.set = others.points() == points ? others : PointSet(std::move(points));
  std::copy(removed_multiplicity.begin(), removed_multiplicity.end(), cloud.multiplicity.begin() + static_cast<std::ptrdiff_t>(staying));
  for (std::uint32_t& p : cloud.point_of) {
    if (p < renumbered.size()) p = renumbered[p];
  }
  return removed;
}

}  // namespace g3r
