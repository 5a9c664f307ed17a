#include "io/splat_light.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "cpu/parallel_sort.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace g3r::io {
namespace {

using vector::dot;

constexpr double kHalf = 0.5;            // The surface is where so much of the light is stopped (Gaussian Opacity Fields).
constexpr double kFaintest = 1.0 / 255;  // Renderers do not draw what stops less, so it stops no light here.
constexpr std::size_t kAxes = 32;  // Rays run along so many lines, both ways; with half as many, hollows lose splats that pictures show.
// The share of the splats from which hidden ones are not inside a solid: pictures taken from within have more.
constexpr double kMostHidden = 1.0 / 3;
// The splats that a ray meets at most: it bounds the time that hostile files take, and in scans rays meet tens.
constexpr std::size_t kMostLookedAt = 4096;
// The splats whose centres are in a tile, and the tiles that a splat is in, on the average: large splats make tiles larger. Both trade
// lists that are short for lists that are few.
constexpr double kPerTile = 8;
constexpr std::size_t kMostTiles = 16;
// The share of the splats at either end of an axis of the picture that tiles do not resolve: a few in the sky would make all tiles too
// large.
constexpr double kOuter = 0.01;
constexpr double kEdgeOn = 1e-6;      // A disc seen from its edge has this share of its spread across: it keeps a place in the picture.
constexpr double kLargest = 1e100;    // Coordinates and scales up to this have squares of products that are finite,
constexpr double kSmallest = 1e-100;  // and from this on such that are above 0.

bool is_drawn(const Splat& splat) {
  const auto sound = [](double value) { return std::abs(value) <= kLargest; };
  return std::all_of(splat.centre.begin(), splat.centre.end(), sound) &&
         std::all_of(splat.scale.begin(), splat.scale.end(), [](double s) { return s >= kSmallest && s <= kLargest; }) &&
         splat.opacity >= kFaintest;
}

// Directions spread evenly over half a sphere.
Vec3 axis_of(std::size_t i) {
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  const double z = (static_cast<double>(i) + 0.5) / kAxes;
  const double r = std::sqrt(1 - z * z);
  const double turn = golden * static_cast<double>(i);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// A splat as it appears along an axis.
struct Image {
  double x = 0, y = 0, depth = 0;
  double xx = 0, xy = 0, yy = 0;  // inverse of its covariance
  double width = 0, height = 0;   // half sides of what is drawn
};

// m^2 at which it is drawn no more.
double squared_reach(const Splat& splat) { return 2 * std::log(splat.opacity / kFaintest); }

Image image_of(const Splat& splat, const Vec3& right, const Vec3& up, const Vec3& ahead) {
  Image image{dot(right, splat.centre), dot(up, splat.centre), dot(ahead, splat.centre)};
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = splat.scale[k] * dot(right, splat.axes[k]), y = splat.scale[k] * dot(up, splat.axes[k]);
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  const double least = kEdgeOn * (xx + yy);
  xx += least;
  yy += least;
  const double reach = squared_reach(splat);
  image.width = std::sqrt(reach * xx);
  image.height = std::sqrt(reach * yy);
  const double scale = xx + yy;  // the determinant of scales of 1e-100 would be 0
  const double determinant = (xx / scale) * (yy / scale) - (xy / scale) * (xy / scale);
  image.xx = yy / scale / determinant / scale;
  image.xy = -xy / scale / determinant / scale;
  image.yy = xx / scale / determinant / scale;
  return image;
}

// What a splat takes of the light at a place where the square of the Mahalanobis distance is so much.
double taken(const Splat& splat, double squared) {
  const double share = splat.opacity * std::exp(-squared / 2);
  return share >= kFaintest ? std::min(share, 1.0) : 0;
}

double squared_distance(const Splat& splat, const Vec3& place) {
  const Vec3 d = vector::subtract(place, splat.centre);
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = dot(d, splat.axes[k]) / splat.scale[k];
    sum += along * along;
  }
  return sum;
}

// One axis of the picture, cut into tiles. Those at the ends hold what lies beyond.
struct Ruler {
  double low = 0, step = 1;
  std::size_t tiles = 1;

  Ruler(std::vector<double> values, std::size_t count) : tiles(count) {
    const auto outer = static_cast<std::ptrdiff_t>(kOuter * static_cast<double>(values.size()));
    std::nth_element(values.begin(), values.begin() + outer, values.end());
    low = values[static_cast<std::size_t>(outer)];
    std::nth_element(values.begin(), values.end() - 1 - outer, values.end());
    const double high = values[values.size() - 1 - static_cast<std::size_t>(outer)];
    if (high > low) step = std::max((high - low) / static_cast<double>(tiles), kSmallest);
  }
  [[nodiscard]] std::size_t operator()(double value) const {
    return static_cast<std::size_t>(std::clamp((value - low) / step, 0.0, static_cast<double>(tiles - 1)));
  }
};

// The splats along one axis: for every tile of the picture those that are drawn in it, from near to far.
class View {
 public:
  View(const std::vector<Splat>& splats, const std::vector<std::uint32_t>& drawn, const Vec3& ahead, const std::atomic<bool>* cancel)
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

  // Whether more than half of the light gets to the centre of splat i from one end of the axis, or it cannot be told.
  [[nodiscard]] bool is_lit(std::uint32_t i) const {
    const std::size_t tile = tile_of(i);
    const auto begin = list_.begin() + static_cast<std::ptrdiff_t>(start_[tile]);
    const auto end = list_.begin() + static_cast<std::ptrdiff_t>(start_[tile + 1]);
    return reaches(i, begin, end) || reaches(i, std::make_reverse_iterator(end), std::make_reverse_iterator(begin));
  }

  // Whether the splats together stop half of the light at the centre of splat i, or it cannot be told.
  [[nodiscard]] bool is_solid(std::uint32_t i) const {
    const std::size_t tile = tile_of(i);
    if (start_[tile + 1] - start_[tile] > kMostLookedAt) return true;
    double passes = 1;
    for (std::size_t k = start_[tile]; k < start_[tile + 1] && passes > kHalf; ++k) {
      const Splat& other = splats_[list_[k]];
      passes *= 1 - taken(other, squared_distance(other, splats_[i].centre));
    }
    return passes <= kHalf;
  }

 private:
  [[nodiscard]] std::size_t tile_of(std::uint32_t i) const { return (*down_)(images_[i].y) * across_->tiles + (*across_)(images_[i].x); }

  // visit(tile) for the tiles that splat i is drawn in.
  template <class Visit>
  void for_tiles(std::uint32_t i, const Visit& visit) const {
    const Image& image = images_[i];
    const std::size_t left = (*across_)(image.x - image.width), right = (*across_)(image.x + image.width);
    const std::size_t bottom = (*down_)(image.y + image.height);
    for (std::size_t row = (*down_)(image.y - image.height); row <= bottom; ++row) {
      for (std::size_t column = left; column <= right; ++column) visit(row * across_->tiles + column);
    }
  }

  [[nodiscard]] std::size_t entries() const {
    return parallel::sum_blocks<std::size_t>(drawn_.size(), parallel::kSmallBlock, 0, [&](std::size_t begin, std::size_t end) {
      std::size_t sum = 0;
      for (std::size_t k = begin; k < end; ++k) {
        const Image& image = images_[drawn_[k]];
        sum += ((*across_)(image.x + image.width) - (*across_)(image.x - image.width) + 1) *
               ((*down_)(image.y + image.height) - (*down_)(image.y - image.height) + 1);
      }
      return sum;
    });
  }

  void cut() {
    std::vector<double> x, y;
    for (const std::uint32_t i : drawn_) {
      x.push_back(images_[i].x);
      y.push_back(images_[i].y);
    }
    for (auto tiles = static_cast<std::size_t>(std::sqrt(static_cast<double>(drawn_.size()) / kPerTile) + 1);; tiles = (tiles + 1) / 2) {
      across_.emplace(x, tiles);
      down_.emplace(y, tiles);
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
  [[nodiscard]] bool reaches(std::uint32_t i, Iterator begin, Iterator end) const {
    const Image& at = images_[i];
    double passes = 1;
    std::size_t looked_at = 0;
    for (Iterator k = begin; k != end && *k != i; ++k) {
      if (++looked_at > kMostLookedAt) return true;
      const Image& image = images_[*k];
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

  const std::vector<Splat>& splats_;
  const std::vector<std::uint32_t>& drawn_;
  std::vector<Image> images_;
  std::optional<Ruler> across_, down_;
  std::vector<std::size_t> start_;  // of every tile, and the end
  std::vector<std::uint32_t> list_;
};

std::vector<SplatPlace> find_places(const std::vector<Splat>& splats, const std::atomic<bool>* cancel) {
  std::vector<SplatPlace> place(splats.size(), SplatPlace::kSurface);
  std::vector<std::uint32_t> drawn;
  for (std::uint32_t i = 0; i < splats.size(); ++i) {
    if (is_drawn(splats[i])) drawn.push_back(i);
    if (splats[i].opacity < kFaintest) place[i] = SplatPlace::kTranslucent;
  }
  if (drawn.empty()) return place;
  const auto those_not = [cancel](const std::vector<std::uint32_t>& some, const auto& is_so) {
    std::vector<std::uint8_t> so(some.size());
    parallel::for_blocks(
        some.size(), parallel::kSmallBlock,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) so[k] = is_so(some[k]) ? 1 : 0;
        },
        cancel);
    std::vector<std::uint32_t> rest;
    for (std::size_t k = 0; k < some.size(); ++k) {
      if (so[k] == 0) rest.push_back(some[k]);
    }
    return rest;
  };
  const auto is_on_surface = [&](std::uint32_t i) { return place[i] == SplatPlace::kSurface; };
  {
    const View all(splats, drawn, axis_of(0), cancel);
    for (const std::uint32_t i : those_not(drawn, [&](std::uint32_t k) { return all.is_solid(k); })) place[i] = SplatPlace::kTranslucent;
  }
  drawn.erase(std::remove_if(drawn.begin(), drawn.end(), [&](std::uint32_t i) { return !is_on_surface(i); }), drawn.end());
  std::vector<std::uint32_t> dark = drawn;
  for (std::size_t axis = 0; axis < kAxes && !dark.empty(); ++axis) {
    const View solid(splats, drawn, axis_of(axis), cancel);
    dark = those_not(dark, [&](std::uint32_t i) { return solid.is_lit(i); });
  }
  if (static_cast<double>(dark.size()) > kMostHidden * static_cast<double>(drawn.size())) return place;
  for (const std::uint32_t i : dark) place[i] = SplatPlace::kHidden;
  return place;
}

}  // namespace

std::array<std::array<double, 3>, 3> axes_of(const std::array<double, 4>& quaternion) {
  const double length = std::hypot(std::hypot(quaternion[0], quaternion[1]), std::hypot(quaternion[2], quaternion[3]));
  if (!(length > 0) || !std::isfinite(length)) return Splat{}.axes;
  const double w = quaternion[0] / length, x = quaternion[1] / length, y = quaternion[2] / length, z = quaternion[3] / length;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
           {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
           {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}

std::vector<SplatPlace> places_of(const std::vector<Splat>& splats, int threads, const std::atomic<bool>* cancel) {
  return parallel::with_threads(threads, [&] { return find_places(splats, cancel); });
}

}  // namespace g3r::io
