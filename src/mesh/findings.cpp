#include "mesh/findings.h"

#include "base/number_text.h"
#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/noise.h"
#include "cloud/some_places.h"
#include "mesh/constants.h"
#include "mesh/crossings.h"
#include "mesh/lines.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace g3r {
namespace {

// These decide on warnings alone. The handles or parts below which nothing is said: so few may be the shape's own.
constexpr std::size_t kFewestOdd = 10;
// The points for each handle, and for each part, that a mesh needs: the smallest handle that was right, in a lattice of rods, had 156.
constexpr std::size_t kPointsPerOdd = 150;

std::string two_digits(double value) { return short_number(value, 2); }

// The step of the terraces across an axis, 0 if there are none.
double terrace_step(const PointSet& set, const std::vector<Vec3>& normals, std::size_t axis) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  const std::size_t stride = set.near_count(), count = std::min(mesh::kRing + 1, stride);
  const SomePlaces some = SomePlaces::at_least(kPlaces, points.size());
  std::size_t pairs = 0, across = 0, single = 0;
  std::vector<double> steps;
  for (std::size_t s = 0; s < some.size(); ++s) {
    const std::size_t i = some[s];
    if (std::fabs(normals[i][axis]) < mesh::kAlong) continue;
    const std::uint32_t* const around = set.near().data() + i * stride;
    const auto is_opposite = [&](std::uint32_t j) { return vector::dot(normals[i], normals[j]) < 0; };
    ++across;
    if (std::any_of(around, around + count, is_opposite)) continue;  // of slats, the next that face the same way are steps away too
    ++single;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t j = around[k];
      if (j == i || std::fabs(normals[j][axis]) < mesh::kAlong || vector::dot(normals[i], normals[j]) < mesh::kAlong) continue;
      ++pairs;
      const double step = std::fabs(points[i][axis] - points[j][axis]);
      if (step > mesh::kRounding * spacing) steps.push_back(step);
    }
  }
  if (pairs < mesh::kFewestPoints || 2 * single < across || steps.empty()) return 0;
  const double same = 1 - static_cast<double>(steps.size()) / static_cast<double>(pairs);
  // Terraces have some pairs of the same height, surfaces that are not flat have none, and single steps on flat ones are shape.
  if (same < mesh::kLittle || same > mesh::kNearlyAll) return 0;
  std::sort(steps.begin(), steps.end());
  const double low = steps[static_cast<std::size_t>(mesh::kLittle * static_cast<double>(steps.size()))];
  // Without steps differences come in all sizes, and the lowest are nearly none. Smaller steps are below the noise of clean clouds, and
  // larger ones are stairs.
  return low >= mesh::kNoisy * spacing && low <= mesh::kFarSpacings * spacing ? low : 0;
}

void warn_of_lines(const CanonicalCloud& cloud, Stats& stats) {
  const std::vector<std::uint8_t> along = mesh::points_along_curves(cloud.points(), cloud.set.near());
  const auto count = std::count(along.begin(), along.end(), std::uint8_t{1});
  const double share = static_cast<double>(count) / static_cast<double>(along.size());
  if (share < mesh::kInLines) return;
  stats.warnings.push_back(
      "sampled in lines: " + percent(share) +
      " of the points lie along a curve with their neighbours; between the lines surface and sides are a guess: measure "
      "closer lines, or keep fewer points along them");
}

void warn_of_crossings(const CanonicalCloud& cloud, const std::vector<Vec3>& normals, Stats& stats) {
  const mesh::Crossings found = mesh::find_crossings(cloud.set, normals);
  if (!found.is_clear) return;
  stats.warnings.push_back("two surfaces cross: " + two_digits(100 * found.share) +
                           " % of the points are near a curve where both go on to either side, at about " + two_digits(found.angle) +
                           " degrees; between the two, inside and outside are a guess: align the scans, or mesh the parts one by one");
}

}  // namespace

void warn_of_sampling(const CanonicalCloud& cloud, const std::vector<Vec3>& normals, Stats& stats) {
  if (cloud.size() < mesh::kFewestPoints) return;
  const double spacing = cloud.set.spacing();
  warn_of_lines(cloud, stats);
  warn_of_crossings(cloud, normals, stats);
  std::string axes;
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step = terrace_step(cloud.set, normals, axis);
    if (step == 0 || cloud.set.rounding_steps()[axis] == 0) continue;  // of a thin wall, the other side is a step away
    axes += (axes.empty() ? "" : ", ") + std::string(1, "xyz"[axis]);
    largest = std::max(largest, step);
  }
  if (axes.empty()) return;
  const double deviation = cloud.frame.length_to_world(largest * std::sqrt(kRoundingVariance));
  stats.warnings.push_back("rounded coordinates: along " + axes + " they come in steps of about " +
                           two_digits(cloud.frame.length_to_world(largest)) + " (" + two_digits(largest / spacing) + " spacings), " +
                           (stats.noise >= deviation ? "which are smoothed over as noise of " + two_digits(stats.noise)
                                                     : "which makes terraces: export more digits, or smooth over them with a noise of " +
                                                           two_digits(deviation) + " or more"));
}

void warn_of_topology(const MeshCheck& check, Stats& stats) {
  const auto points = stats.used;
  const auto handles = static_cast<std::size_t>(std::max(0L, check.genus));
  if (handles >= kFewestOdd && points < kPointsPerOdd * handles) {
    stats.doubtful = true;
    stats.warnings.push_back("genus " + std::to_string(handles) + ": one handle for every " + std::to_string(points / handles) +
                             " points is more than they can carry: walls or gaps below the spacing, or noise taken for shape; measure more "
                             "points, or give the noise");
  }
  if (check.components >= kFewestOdd && points < kPointsPerOdd * check.components) {
    stats.doubtful = true;
    stats.warnings.push_back(
        std::to_string(check.components) + " parts: one for every " + std::to_string(points / check.components) +
        " points is more than they can carry: outliers, noise or gaps in the sampling; keep the largest, or clean the cloud");
  }
}

void warn_of_faces(std::size_t triangles, std::size_t faces, std::size_t new_crossings, std::vector<std::string>& warnings) {
  if (new_crossings > 0) {
    warnings.push_back("so few triangles intersect each other: " + std::to_string(new_crossings) +
                       (new_crossings == 1 ? " pair" : " pairs") + " more than before simplifying; ask for more triangles");
  }
  if (faces == 0 || triangles <= faces) return;
  warnings.push_back(std::to_string(triangles) + " triangles instead of " + std::to_string(faces) +
                     ": fewer would open the mesh or change its parts or handles; keep the largest part, or ask for more");
}

}  // namespace g3r
