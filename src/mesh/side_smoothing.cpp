#include "mesh/side_smoothing.h"

#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <array>
#include <cmath>
#include <limits>

namespace g3r::mesh {
namespace {

// The leaves around a corner, each with the corner's place in it.
struct Around {
  std::array<std::uint32_t, kOctants> leaf{};
  std::array<std::uint8_t, kOctants> place{};
  std::uint8_t count = 0;
};

// `number`: of the corners, among the ambiguous ones.
std::vector<Around> leaves_around(const Octree& octree, const std::vector<std::uint32_t>& number, std::size_t ambiguous) {
  std::vector<Around> out(ambiguous);
  for (std::uint32_t leaf = 0; leaf < octree.leaf_count(); ++leaf) {
    for (std::uint8_t place = 0; place < kOctants; ++place) {
      const std::uint32_t k = number[octree.corner(leaf, place)];
      if (k == kNone) continue;
      Around& a = out[k];
      a.leaf[a.count] = leaf;
      a.place[a.count++] = place;
    }
  }
  return out;
}

// Weights of the corners around one, by how far they are along the patch with normal n: at the middle + x + 3 (y + 3 z) for the corner
// (x, y, z) leaf sides away, each -1, 0 or 1. The standard deviation across the patch is the half thickness of the discs that leaves
// resolve: corners of the next layer are on the other side of the surface, and must not count.
std::array<double, kLatticeSize> weights(const std::array<float, 3>& n) {
  std::array<double, kLatticeSize> out{};
  for (std::size_t i = 0; i <= out.size() / 2; ++i) {
    const std::size_t y = i / kLatticeSide % kLatticeSide, z = i / kLatticeSide / kLatticeSide;
    const double across =
        n[0] * (static_cast<double>(i % kLatticeSide) - 1) + n[1] * (static_cast<double>(y) - 1) + n[2] * (static_cast<double>(z) - 1);
    out[i] = out[out.size() - 1 - i] = std::exp(-across * across / (2 * kDiscHalf * kDiscHalf));
  }
  return out;
}

}  // namespace

std::vector<std::vector<float>> smooth_sides(const Octree& octree, const AmbiguousCorners& ambiguous,
                                             const std::vector<std::uint8_t>& inside, std::size_t times, const std::atomic<bool>* cancel) {
  std::vector<std::uint32_t> number(octree.corner_count(), kNone);
  for (std::uint32_t k = 0; k < ambiguous.corner.size(); ++k) number[ambiguous.corner[k]] = k;
  const std::vector<Around> around = leaves_around(octree, number, ambiguous.corner.size());
  const auto average = [&](std::size_t k, const std::vector<float>& side) {
    const Around& a = around[k];
    const std::array<double, kLatticeSize> along = weights(ambiguous.axis[k]);
    double sum = 0, total = 0;
    for (std::size_t i = 0; i < a.count; ++i) {
      for (std::uint32_t other = 0; other < kOctants; ++other) {
        if (other == a.place[i]) continue;
        const std::uint32_t c = octree.corner(a.leaf[i], other);
        const double weight = along[along.size() / 2 + lattice_place(other) - lattice_place(a.place[i])];
        sum += weight * (number[c] != kNone ? static_cast<double>(side[number[c]]) : inside[c] != 0 ? 1.0 : -1.0);
        total += weight;
      }
    }
    // A corner's own value has half the weight of the mean of its neighbours: with more, smoothing needs more passes; with less, single
    // corners have no say.
    const double own = static_cast<double>(ambiguous.value[k]);
    return static_cast<float>(total > 0 ? (0.5 * own + sum / total) / (0.5 + 1) : own);
  };
  std::vector<std::vector<float>> out(times, ambiguous.value);
  for (std::size_t t = 0; t < times; ++t) {
    const std::vector<float>& value = t == 0 ? ambiguous.value : out[t - 1];
    parallel::for_blocks(
        around.size(), parallel::kSmallBlock,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) out[t][k] = average(k, value);
        },
        cancel);
  }
  return out;
}

}  // namespace g3r::mesh
