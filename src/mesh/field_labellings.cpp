#include "mesh/field_labellings.h"

#include "mesh/field_corners.h"

#include <algorithm>
#include <array>
#include <utility>

namespace g3r::mesh {
namespace {

// A candidate labelling: the signs of the ambiguous corners after so many smoothing passes, at some iso-level: none, that from which the
// field is sure, and the middle between none and the largest value.
struct Labelling {
  std::size_t passes;
  double level;
};
constexpr std::array kLabellings{Labelling{2, 0},           Labelling{0, 0},   Labelling{1, kFieldSure},
                                 Labelling{1, -kFieldSure}, Labelling{1, 0.5}, Labelling{1, -0.5}};

// Which of the corners that a labelling changes a proposal changes: if all of them come to be inside, or outside, its groups are smaller,
// and some can be taken that are too large otherwise.
enum class Way { kBoth, kFill, kCut };

// A number for each corner, below kOctants: no two corners of a leaf have the same, but where leaves differ in size. A leaf's corners are
// even or odd along each axis, in units of its side; a corner counts in those of the smallest leaf that has it.
std::vector<std::uint8_t> colours(const Octree& octree) {
  std::vector<std::uint8_t> out(octree.corner_count(), 0);  // levels first
  for (std::uint32_t leaf = 0; leaf < octree.leaf_count(); ++leaf) {
    const std::uint8_t level = octree.leaf(leaf).level;
    for (const std::uint32_t c : octree.corners(leaf)) out[c] = std::max(out[c], level);
  }
  for (std::uint32_t c = 0; c < out.size(); ++c) {
    const std::array<std::uint32_t, 3> grid = octree.corner_grid(c);
    const int shift = kMaxOctreeLevel - out[c];
    out[c] = 0;
    for (std::size_t a = 0; a < grid.size(); ++a) out[c] |= static_cast<std::uint8_t>(((grid[a] >> shift) & 1U) << a);
  }
  return out;
}

}  // namespace

void remove_handles(const Octree& octree, const AmbiguousCorners& ambiguous, const HandlePrice& price, const InsideTest& centre_inside,
                    std::vector<std::uint8_t>& inside, const std::atomic<bool>* cancel) {
  DualSurface surface = patches_of(octree, inside, centre_inside, cancel);
  const std::vector<std::vector<float>> smoothed = smooth_sides(octree, ambiguous, inside, 2, cancel);
  const auto sign = [&](const Labelling& labelling, std::uint32_t place) -> std::uint8_t {
    const std::vector<float>& value = labelling.passes == 0 ? ambiguous.value : smoothed[labelling.passes - 1];
    return value[place] > labelling.level ? 1 : 0;
  };
  std::vector<std::uint8_t> is_ambiguous(inside.size(), 0);
  std::vector<std::uint32_t> changing;  // places among the ambiguous corners that some labelling changes
  for (std::uint32_t k = 0; k < ambiguous.corner.size(); ++k) {
    const std::uint32_t c = ambiguous.corner[k];
    if (octree.on_boundary(c) || !price.may_change(c)) continue;
    if (std::all_of(kLabellings.begin(), kLabellings.end(), [&](const Labelling& r) { return sign(r, k) == inside[c]; })) continue;
    is_ambiguous[c] = 1;
    changing.push_back(k);
  }
  HandleRemoval removal(octree, is_ambiguous, inside, std::move(surface), centre_inside, price.held, price.most_per_handle, cancel);
  const std::vector<std::uint8_t> before = inside;
  for (const Labelling& labelling : kLabellings) {
    for (const Way way : {Way::kBoth, Way::kFill, Way::kCut}) {
      // What the values say may still show that a tube joins two components.
      if (removal.handles() == 0 && labelling.level != 0) break;
      std::vector<std::uint8_t> proposal = inside;
      for (const std::uint32_t k : changing) {
        const std::uint8_t now = sign(labelling, k);
        if (way == Way::kBoth || (now != 0) == (way == Way::kFill)) proposal[ambiguous.corner[k]] = now;
      }
      (void)removal.propose(proposal, inside);
    }
  }
  // Then single corners, each a group of its own: of a labelling they hang together with more than a handle is worth.
  const std::vector<std::uint8_t> colour = colours(octree);
  for (std::uint8_t which = 0; which < kOctants; ++which) {
    std::vector<std::uint8_t> proposal = inside;
    for (const std::uint32_t k : changing) {
      const std::uint32_t c = ambiguous.corner[k];
      if (colour[c] == which) proposal[c] = inside[c] == 0 ? 1 : 0;
    }
    (void)removal.propose(proposal, inside);
  }
  // A ring of few points has no handle where it is gone: then it stays.
  if (std::none_of(inside.begin(), inside.end(), [](std::uint8_t side) { return side != 0; })) inside = before;
}

}  // namespace g3r::mesh
