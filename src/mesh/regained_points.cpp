#include "mesh/regained_points.h"

#include "cloud/chance.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/field_denoise.h"
#include "mesh/field_local_fit.h"
#include "mesh/field_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace g3r::mesh {
namespace {

// The points and strays around a place that are counted, so many and twice as many: fewer are often on a surface by chance, and around
// more it is bent.
constexpr std::array<std::size_t, 2> kAround{2 * kFitPoints, 4 * kFitPoints};

// The surface of some points where it goes through a place, and how thick a layer of points it has.
struct Passing {
  LocalSurface surface;
  double thickness = 0;

  [[nodiscard]] bool holds(const Vec3& p) const { return std::abs(surface.distance(to_eigen(p))) <= thickness; }
  [[nodiscard]] Vec3 normal_at(const Vec3& p) const {
    int active = 0;
    surface.distance(to_eigen(p), &active);
    Eigen::Vector3d n;
    (void)surface.patch[static_cast<std::size_t>(active)].distance(to_eigen(p), &n);
    return n.allFinite() ? Vec3{n[0], n[1], n[2]} : Vec3{0, 0, 0};
  }
};

// Whether more of the points and strays around the place are in the layers of the patches than chance puts there. `everything`: both.
bool is_among_its_points(const Passing& passing, const Vec3& place, const Neighbours& around, const std::vector<Vec3>& everything) {
  if (passing.surface.count == 0 || !passing.holds(place)) return false;
  std::vector<std::uint32_t> near;
  std::vector<double> squared;
  return std::any_of(kAround.begin(), kAround.end(), [&](std::size_t count) {
    around.nearest(place, count, near, squared);  // itself the first
    const auto on = std::count_if(near.begin() + 1, near.end(), [&](std::uint32_t i) { return passing.holds(everything[i]); });
    const double share = passing.surface.count * share_of_ball(passing.thickness / std::sqrt(squared.back()));
    return on >= static_cast<std::ptrdiff_t>(proving_number(near.size() - 1, std::min(share, 1.0), kAround.size()));
  });
}

}  // namespace

std::vector<Vec3> normals_of_regained(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<Vec3>& strays,
                                      const std::atomic<bool>* cancel) {
  std::vector<Vec3> out(strays.size(), Vec3{0, 0, 0});
  std::vector<Vec3> positions = points, directions = normals, all = points;
  all.insert(all.end(), strays.begin(), strays.end());
  const Neighbours around(all);
  std::vector<std::uint32_t> open(strays.size());
  std::iota(open.begin(), open.end(), std::uint32_t{0});
  for (bool found = points.size() > kFitPoints; found && !open.empty();) {
    Prepared prepared;
    prepare(positions, directions, 0, prepared);
    const double noise = prepared.typical * noise_seen(noise_about_fits(prepared.points, *prepared.neighbours, prepared.typical));
    const LocalFit local(prepared.points, *prepared.neighbours, prepared.near);
    parallel::for_blocks(
        open.size(), parallel::kSmallBlock,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) {
            const Vec3& place = strays[open[k]];
            Passing passing{local.fit(to_eigen(place), kGap), 0};
            passing.thickness = kDiscHalf * passing.surface.spacing + noise;
            if (is_among_its_points(passing, place, around, all)) out[open[k]] = passing.normal_at(place);
          }
        },
        cancel);
    std::vector<std::uint32_t> left;
    for (const std::uint32_t i : open) {
      if (out[i] == Vec3{0, 0, 0}) {
        left.push_back(i);
      } else {
        positions.push_back(strays[i]);
        directions.push_back(out[i]);
      }
    }
    found = left.size() < open.size();
    open = std::move(left);
  }
  return out;
}

}  // namespace g3r::mesh
