#include "tiles/spacing_sample.h"

#include "base/hash.h"
#include "base/median.h"
#include "mesh/smooth_spacing.h"

#include <algorithm>
#include <cmath>

namespace g3r::tiles {
namespace {

constexpr std::size_t kMost = std::size_t{1} << 17U;  // points kept; with 10,000 the folds of a statue look like thick patches
constexpr std::size_t kFewest = 100;                  // that tell a spacing

}  // namespace

void SpacingSample::add(const Vec3& point) {
  const auto stays = [this](std::uint64_t h) { return halvings_ == 0 || h >> (64U - static_cast<unsigned>(halvings_)) == 0; };
  const std::uint64_t h = mixed(count_++);
  if (!stays(h)) return;
  kept_.emplace_back(h, point);
  if (kept_.size() <= kMost) return;
  ++halvings_;
  std::erase_if(kept_, [&](const auto& kept) { return !stays(kept.first); });
}

double SpacingSample::spacing() const {
  if (kept_.size() < kFewest) return 0;
  std::vector<Vec3> points;
  points.reserve(kept_.size());
  for (const auto& kept : kept_) points.push_back(kept.second);
  return median(mesh::smooth_spacing(points)) * std::sqrt(static_cast<double>(kept_.size()) / static_cast<double>(count_));
}

}  // namespace g3r::tiles
