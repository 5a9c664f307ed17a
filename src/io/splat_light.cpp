#include "io/splat_light.h"

#include "cpu/parallel.h"
#include "io/splat_image.h"
#include "io/splat_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace g3r::io {
namespace {

constexpr std::size_t kAxes = 32;  // Rays run along so many lines, both ways; with half as many, hollows lose splats that pictures show.
// The share of the splats from which hidden ones are not inside a solid: pictures taken from within have more.
constexpr double kMostHidden = 1.0 / 3;

// Directions spread evenly over half a sphere.
Vec3 axis_of(std::size_t i) {
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  const double z = (static_cast<double>(i) + 0.5) / kAxes;
  const double r = std::sqrt(1 - z * z);
  const double turn = golden * static_cast<double>(i);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

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
    const SplatView all(splats, drawn, axis_of(0), cancel);
    for (const std::uint32_t i : those_not(drawn, [&](std::uint32_t k) { return all.is_solid(k); })) place[i] = SplatPlace::kTranslucent;
  }
  drawn.erase(std::remove_if(drawn.begin(), drawn.end(), [&](std::uint32_t i) { return !is_on_surface(i); }), drawn.end());
  std::vector<std::uint32_t> dark = drawn;
  for (std::size_t axis = 0; axis < kAxes && !dark.empty(); ++axis) {
    const SplatView solid(splats, drawn, axis_of(axis), cancel);
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
