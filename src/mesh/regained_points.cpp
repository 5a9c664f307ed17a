#include "mesh/regained_points.h"

#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/field_local_fit.h"
#include "mesh/field_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace g3r::mesh {
namespace {

// The points and strays around a place that are counted: of outliers that fill space 14 % are on any surface through them, and of 8 of them
// often as many as on a surface.
constexpr std::size_t kAround = 2 * kFitPoints;

}  // namespace

std::vector<Vec3> normals_of_regained(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<Vec3>& strays,
                                      const std::atomic<bool>* cancel) {
  std::vector<Vec3> out(strays.size(), Vec3{0, 0, 0});
  std::vector<Vec3> positions = points, directions = normals;
  std::vector<Vec3> all = points;
  all.insert(all.end(), strays.begin(), strays.end());
  const Neighbours around(all);
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < strays.size(); ++i) open.push_back(i);
  for (bool found = points.size() > kFitPoints; found && !open.empty();) {
    Prepared prepared;
    prepare(positions, directions, 0, prepared);
    const LocalFit local(prepared.points, *prepared.neighbours, prepared.near);
    parallel::for_blocks(
        open.size(), kBlock,
        [&](std::size_t begin, std::size_t end) {
          std::vector<std::uint32_t> index;
          std::vector<double> squared;
          for (std::size_t k = begin; k < end; ++k) {
            const Vec3& place = strays[open[k]];
            const Eigen::Vector3d x = to_eigen(place);
            const LocalSurface fit = local.fit(x, kGap);
            if (fit.count == 0) continue;
            around.nearest(place, kAround, index, squared);
            // As for the spacing, the area of a disc for each: h = d_m sqrt(pi / m).
            const double spacing = std::sqrt(squared.back() * std::numbers::pi / static_cast<double>(index.size()));
            const double thickness = kDiscHalf * std::min(fit.spacing, spacing);
            const auto is_on = [&](const Vec3& p) { return std::abs(fit.distance(to_eigen(p))) <= thickness; };
            const auto on = std::count_if(index.begin(), index.end(), [&](std::uint32_t i) { return is_on(all[i]); });
            if (!is_on(place) || kRing * static_cast<std::size_t>(on) < kPatchPoints * index.size()) continue;
            int active = 0;
            fit.distance(x, &active);
            Eigen::Vector3d n;
            (void)fit.patch[static_cast<std::size_t>(active)].distance(x, &n);
            if (n.allFinite() && n.norm() > 0) out[open[k]] = {n[0], n[1], n[2]};
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
