#include "mesh/side_smoothing.h"

#include <array>
#include <cmath>
#include <limits>

#include "cpu/parallel.h"

namespace g3r::mesh {
namespace {

constexpr double kOwn = 0.5;      // weight of a corner's own opinion against the mean of its neighbours
constexpr double kAcross = 0.25;  // leaves: standard deviation, across the sheet, of the places that count as along it
constexpr std::size_t kBlock = 4096;
constexpr std::uint32_t kStands = std::numeric_limits<std::uint32_t>::max();

// The leaves around an open corner: 8 at most, each with the corner's place in it.
struct Around {
  std::uint32_t corner = 0;
  std::array<std::uint32_t, 8> leaf{};
  std::array<std::uint8_t, 8> place{};
  std::uint8_t count = 0;
};

std::vector<Around> open_corners(const Octree& octree, const std::vector<std::uint8_t>& open) {
  std::vector<std::uint32_t> number(open.size(), kStands);
  std::vector<Around> out;
  for (std::uint32_t c = 0; c < number.size(); ++c) {
    if (open[c] == 0) continue;
    number[c] = static_cast<std::uint32_t>(out.size());
    out.emplace_back().corner = c;
  }
  for (std::uint32_t leaf = 0; leaf < octree.leaf_count(); ++leaf) {
    for (std::uint8_t place = 0; place < 8; ++place) {
      const std::uint32_t k = number[octree.corners(leaf)[place]];
      if (k == kStands) continue;
      Around& a = out[k];
      a.leaf[a.count] = leaf;
      a.place[a.count++] = place;
    }
  }
  return out;
}

// Weight of the corner at place `other` of a leaf for the one at place `place`: how far it is along the sheet with normal n.
double along(const std::array<float, 3>& n, std::uint32_t place, std::uint32_t other) {
  double across = 0;
  for (std::uint32_t a = 0; a < 3; ++a)
    across += n[a] * (((other >> a) & 1U) != 0 ? 1.0 : 0.0) - n[a] * (((place >> a) & 1U) != 0 ? 1.0 : 0.0);
  return std::exp(-across * across / (2 * kAcross * kAcross));
}

}  // namespace

std::vector<double> smooth_sides(const Octree& octree, const Opinions& opinions, const std::vector<double>& side,
                                 const std::atomic<bool>* cancel) {
  const std::vector<Around> open = open_corners(octree, opinions.open);
  std::vector<double> next = side;
  const auto average = [&](const Around& a) {
    double sum = 0, total = 0;
    for (std::size_t i = 0; i < a.count; ++i) {
      for (std::uint32_t other = 0; other < 8; ++other) {
        if (other == a.place[i]) continue;
        const double weight = along(opinions.axis[a.corner], a.place[i], other);
        sum += weight * side[octree.corners(a.leaf[i])[other]];
        total += weight;
      }
    }
    const double own = opinions.side[a.corner];
    return total > 0 ? (kOwn * own + sum / total) / (kOwn + 1) : own;
  };
  parallel::for_blocks(
      open.size(), kBlock,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) next[open[k].corner] = average(open[k]);
      },
      cancel);
  return next;
}

}  // namespace g3r::mesh
