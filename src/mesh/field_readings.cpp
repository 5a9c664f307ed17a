#include "mesh/field_readings.h"

#include "mesh/handle_removal.h"

#include <algorithm>
#include <array>

namespace g3r::mesh {
namespace {

// A way to read the opinions: after so many averagings, at some level.
struct Reading {
  std::size_t averagings;
  double level;
};
constexpr std::array<Reading, 6> kReadings{{{2, 0}, {0, 0}, {1, 0.2}, {1, -0.2}, {1, 0.5}, {1, -0.5}}};

// What a proposal may change: fewer corners in a group, and so smaller ones that can be taken, if it goes one way only.
enum class Way { kBoth, kFill, kCut };

}  // namespace

bool remove_handles(const Octree& octree, const Opinions& opinions, const std::function<bool(std::uint32_t)>& may_change,
                    const InsideTest& centre_inside, std::vector<std::uint8_t>& inside, const DualSurface& surface,
                    const std::atomic<bool>* cancel) {
  if (count_handles(surface) == 0) return false;
  const std::vector<std::vector<float>> averages = smooth_sides(octree, opinions, inside, 2, cancel);
  const auto sign = [&](const Reading& reading, std::uint32_t place) -> std::uint8_t {
    const std::vector<float>& side = reading.averagings == 0 ? opinions.side : averages[reading.averagings - 1];
    return side[place] > reading.level ? 1 : 0;
  };
  std::vector<std::uint8_t> in_doubt(inside.size(), 0);
  std::vector<std::uint32_t> doubtful;  // places among the opinions
  for (std::uint32_t k = 0; k < opinions.corner.size(); ++k) {
    const std::uint32_t c = opinions.corner[k];
    if (octree.on_boundary(c) || !may_change(c)) continue;
    if (std::all_of(kReadings.begin(), kReadings.end(), [&](const Reading& r) { return sign(r, k) == inside[c]; })) continue;
    in_doubt[c] = 1;
    doubtful.push_back(k);
  }
  HandleRemoval removal(octree, in_doubt, inside, surface, centre_inside, cancel);
  bool changed = false;
  for (const Reading& reading : kReadings) {
    for (const Way way : {Way::kBoth, Way::kFill, Way::kCut}) {
      if (removal.handles() == 0) return changed;
      std::vector<std::uint8_t> proposal = inside;
      for (const std::uint32_t k : doubtful) {
        const std::uint8_t now = sign(reading, k);
        if (way == Way::kBoth || (now != 0) == (way == Way::kFill)) proposal[opinions.corner[k]] = now;
      }
      changed = removal.propose(proposal, inside) || changed;
    }
  }
  return changed;
}

}  // namespace g3r::mesh
