#include "mesh/field_labellings.h"

#include "mesh/field_corners.h"
#include "mesh/handle_removal.h"

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

}  // namespace

void remove_handles(const Octree& octree, const AmbiguousCorners& ambiguous, const HandlePrice& price, const InsideTest& centre_inside,
                    std::vector<std::uint8_t>& inside, const std::atomic<bool>* cancel) {
  DualSurface surface = patches_of(octree, inside, centre_inside, cancel);
  if (count_handles(surface) == 0) return;
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
  HandleRemoval removal(octree, is_ambiguous, inside, std::move(surface), centre_inside, price.most_per_handle, cancel);
  const std::vector<std::uint8_t> before = inside;
  for (const Labelling& labelling : kLabellings) {
    for (const Way way : {Way::kBoth, Way::kFill, Way::kCut}) {
      if (removal.handles() == 0) break;
      std::vector<std::uint8_t> proposal = inside;
      for (const std::uint32_t k : changing) {
        const std::uint8_t now = sign(labelling, k);
        if (way == Way::kBoth || (now != 0) == (way == Way::kFill)) proposal[ambiguous.corner[k]] = now;
      }
      (void)removal.propose(proposal, inside);
    }
  }
  // A ring of few points has no handle where it is gone: then it stays.
  if (std::none_of(inside.begin(), inside.end(), [](std::uint8_t side) { return side != 0; })) inside = before;
}

}  // namespace g3r::mesh
