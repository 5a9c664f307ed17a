#include "io/splat_view.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "cpu/parallel_sort.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace g3r::io {
namespace {

constexpr double kHalf = 0.5;  // The surface is where so much of the light is stopped (Gaussian Opacity Fields).
// The splats that a ray meets at most: it bounds the time that hostile files take, and in scans rays meet tens.
constexpr std::size_t kMostLookedAt = 4096;
// The splats whose centres are in a tile, and the tiles that a splat is in, on the average: large splats make tiles larger. Both trade
// lists that are short for lists that are few.
constexpr double kPerTile = 8;
constexpr std::size_t kMostTiles = 16;
// The share of the splats at either end of an axis of the picture that tiles do not resolve: a few in the sky would make all tiles too
// large.
constexpr double kOuter = 0.01;
constexpr double kLeastStep = 1e-100;  // of tiles: an extent over their number may be 0

}  // namespace

// One axis of the picture, cut into tiles. Those at the ends hold what lies beyond.
struct SplatView::Ruler {
  double low = 0, step = 1;
  std::size_t tiles = 1;

  Ruler(std::vector<double> values, std::size_t count) : tiles(count) {
    const auto outer = static_cast<std::ptrdiff_t>(kOuter * static_cast<double>(values.size()));
    std::nth_element(values.begin(), values.begin() + outer, values.end());
    low = values[static_cast<std::size_t>(outer)];
    std::nth_element(values.begin(), values.end() - 1 - outer, values.end());
    const double high = values[values.size() - 1 - static_cast<std::size_t>(outer)];
    if (high > low) step = std::max((high - low) / static_cast<double>(tiles), kLeastStep);
  }
  [[nodiscard]] std::size_t operator()(double value) const {
    return static_cast<std::size_t>(std::clamp((value - low) / step, 0.0, static_cast<double>(tiles - 1)));
  }
};

SplatView::SplatView(const std::vector<Splat>& splats, const std::vector<std::uint32_t>& drawn, const Vec3& ahead,
                     const std::atomic<bool>* cancel)
    : splats_(splats), drawn_(drawn) {
  const Vec3 other = std::abs(ahead[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 right = vector::normalised(vector::cross(other, ahead));
  const Vec3 up = vector::cross(ahead, right);
  images_.resize(splats.size());
  parallel::for_blocks(
      drawn.size(), parallel::kSmallBlock,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) images_[drawn[k]] = image_of(splats[drawn[k]], right, up, ahead);
      },
      cancel);
  cut();
}

SplatView::~SplatView() = default;

bool SplatView::is_lit(std::uint32_t i) const {
  const std::size_t tile = tile_of(i);
  const auto begin = list_.begin() + static_cast<std::ptrdiff_t>(start_[tile]);
  const auto end = list_.begin() + static_cast<std::ptrdiff_t>(start_[tile + 1]);
  return reaches(i, begin, end) || reaches(i, std::make_reverse_iterator(end), std::make_reverse_iterator(begin));
}

bool SplatView::is_solid(std::uint32_t i) const {
  const std::size_t tile = tile_of(i);
  if (start_[tile + 1] - start_[tile] > kMostLookedAt) return true;
  double passes = 1;
  for (std::size_t k = start_[tile]; k < start_[tile + 1] && passes > kHalf; ++k) {
    const Splat& other = splats_[list_[k]];
    passes *= 1 - taken(other, squared_distance(other, splats_[i].centre));
  }
  return passes <= kHalf;
}

std::size_t SplatView::tile_of(std::uint32_t i) const { return (*down_)(images_[i].y) * across_->tiles + (*across_)(images_[i].x); }

// visit(tile) for the tiles that splat i is drawn in.
template <class Visit>
void SplatView::for_tiles(std::uint32_t i, const Visit& visit) const {
  const SplatImage& image = images_[i];
  const std::size_t left = (*across_)(image.x - image.width), right = (*across_)(image.x + image.width);
  const std::size_t bottom = (*down_)(image.y + image.height);
  for (std::size_t row = (*down_)(image.y - image.height); row <= bottom; ++row) {
    for (std::size_t column = left; column <= right; ++column) visit(row * across_->tiles + column);
  }
}

std::size_t SplatView::entries() const {
  return parallel::sum_blocks<std::size_t>(drawn_.size(), parallel::kSmallBlock, 0, [&](std::size_t begin, std::size_t end) {
    std::size_t sum = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const SplatImage& image = images_[drawn_[k]];
      sum += ((*across_)(image.x + image.width) - (*across_)(image.x - image.width) + 1) *
             ((*down_)(image.y + image.height) - (*down_)(image.y - image.height) + 1);
    }
    return sum;
  });
}

void SplatView::cut() {
  std::vector<double> x, y;
  for (const std::uint32_t i : drawn_) {
    x.push_back(images_[i].x);
    y.push_back(images_[i].y);
  }
  for (auto tiles = static_cast<std::size_t>(std::sqrt(static_cast<double>(drawn_.size()) / kPerTile) + 1);; tiles = (tiles + 1) / 2) {
    across_ = std::make_unique<Ruler>(x, tiles);
    down_ = std::make_unique<Ruler>(y, tiles);
    if (tiles == 1 || entries() <= kMostTiles * drawn_.size()) break;
  }
  std::vector<std::uint32_t> order = drawn_;
  parallel::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return images_[a].depth != images_[b].depth ? images_[a].depth < images_[b].depth : a < b;
  });
  start_.assign(across_->tiles * down_->tiles + 1, 0);
  for (const std::uint32_t i : order) for_tiles(i, [&](std::size_t tile) { ++start_[tile + 1]; });
  for (std::size_t tile = 1; tile < start_.size(); ++tile) start_[tile] += start_[tile - 1];
  list_.resize(start_.back());
  std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
  for (const std::uint32_t i : order) for_tiles(i, [&](std::size_t tile) { list_[next[tile]++] = i; });
}

template <class Iterator>
bool SplatView::reaches(std::uint32_t i, Iterator begin, Iterator end) const {
  const SplatImage& at = images_[i];
  double passes = 1;
  std::size_t looked_at = 0;
  for (Iterator k = begin; k != end && *k != i; ++k) {
    if (++looked_at > kMostLookedAt) return true;
    const SplatImage& image = images_[*k];
    const double x = at.x - image.x, y = at.y - image.y;
    if (std::abs(x) > image.width || std::abs(y) > image.height) continue;
    const Splat& other = splats_[*k];
    const double share = taken(other, image.xx * x * x + 2 * image.xy * x * y + image.yy * y * y);
    if (share == 0 || taken(other, squared_distance(other, splats_[i].centre)) > 0) continue;
    passes *= 1 - share;
    if (passes < kHalf) return false;
  }
  return true;
}

}  // namespace g3r::io
