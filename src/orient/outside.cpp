#include "orient/outside.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "orient/agreement.h"
#include "orient/votes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>

namespace g3r {
namespace {

// By the first axis from z to x that the sum of the normals is not level to, as far as a float tells.
bool faces_down(const Vec3& sum) {
  const double size = std::max({std::abs(sum[0]), std::abs(sum[1]), std::abs(sum[2])});
  for (const std::size_t axis : {std::size_t{2}, std::size_t{1}, std::size_t{0}}) {
    if (std::abs(sum[axis]) > std::numeric_limits<float>::epsilon() * size) return sum[axis] < 0;
  }
  return false;
}

// What has an outside of its own: a part, or a group of sites.
struct Units {
  std::vector<std::uint32_t> of;  // M: number of the unit
  std::vector<double> enclosure;  // of every unit
  std::vector<float> held;        // M: the chance that a site has the side of the rest of its unit
};

Units units_of(const SiteParts& parts, const std::vector<std::uint8_t>& is_open, const std::vector<double>& enclosure,
               const std::vector<Vec3>& normals) {
  const Sites& sites = parts.sites();
  const std::vector<Vec3> at = at_sites(sites, normals);
  const std::vector<Hold> hold = held_by_neighbours(sites, at);
  Units units{std::vector<std::uint32_t>(sites.size(), 0), enclosure, std::vector<float>(sites.size(), 1)};
  std::map<std::uint32_t, std::vector<std::uint32_t>> loose;
  for (std::uint32_t p = 0; p < parts.count(); ++p) {
    for (const std::uint32_t s : parts.members(p)) {
      units.of[s] = p;
      if (is_open[p] == 0) continue;
      units.held[s] = hold[s].chance;
      if (static_cast<double>(hold[s].chance) < kMostOf) loose[hold[s].group].push_back(s);
    }
  }
  for (const auto& [group, members] : loose) {
    if (members.size() < kFewestSites) continue;
    const double own = parts.enclosure(members, at);
    if (std::abs(own) <= kUndecided) continue;
    for (const std::uint32_t s : members) {
      units.of[s] = static_cast<std::uint32_t>(units.enclosure.size());
      units.held[s] = 1;
    }
    units.enclosure.push_back(own);
  }
  return units;
}

}  // namespace

void face_outside(const SiteParts& parts, const std::vector<std::uint8_t>& is_open, const std::vector<double>& enclosure,
                  std::vector<Vec3>& normals, OpenSurfaces& found) {
  const std::vector<std::uint32_t>& site_of = parts.sites().site_of;
  const Units units = units_of(parts, is_open, enclosure, normals);
  std::vector<Vec3> sum(units.enclosure.size(), Vec3{0, 0, 0});
  std::vector<std::uint32_t> first(units.enclosure.size(), OpenSurfaces::kNone);
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t unit = units.of[site_of[i]];
    first[unit] = std::min(first[unit], i);
    sum[unit] = vector::add(sum[unit], normals[i]);
  }
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    if (is_open[parts.of_point(i)] == 0) continue;
    const std::uint32_t unit = units.of[site_of[i]];
    const double e = units.enclosure[unit];
    const bool decided = std::abs(e) > kUndecided;
    if (decided ? e < 0 : faces_down(sum[unit])) normals[i] = vector::scale(normals[i], -1);
    found.part[i] = first[unit];
    found.certainty[i] = decided ? static_cast<float>(std::min(1.0, std::abs(e))) : kUndecided;
    found.held[i] = units.held[site_of[i]];
  }
}

}  // namespace g3r
