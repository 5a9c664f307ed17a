#include "tiles/spacing_sample.h"

#include "base/median.h"
#include "mesh/smooth_spacing.h"
#include "tiles/point_hash.h"

#include <cmath>
#include <vector>

namespace g3r::tiles {
namespace {

constexpr std::size_t kMost = std::size_t{1} << 17U;  // points kept; with 10,000 the folds of a statue look like thick patches
constexpr std::size_t kFewest = 100;                  // that tell a spacing

}  // namespace

void SpacingSample::add(const Vec3& point) {
  const std::uint64_t hash = point_hash(point);
  if (hash > last_) return;
  kept_.emplace(hash, point);
  if (kept_.size() <= kMost) return;
  ++halvings_;
  last_ /= 2;
  kept_.erase(kept_.upper_bound(last_), kept_.end());
}

double SpacingSample::spacing() const {
  if (kept_.size() < kFewest) return 0;
  std::vector<Vec3> points;
  points.reserve(kept_.size());
  for (const auto& kept : kept_) points.push_back(kept.second);
  return median(mesh::smooth_spacing(points)) * std::exp2(-0.5 * halvings_);
}

}  // namespace g3r::tiles
