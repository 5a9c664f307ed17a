// The far pairs of interaction lists in the order in which they are summed.
#pragma once

#include "tree/interaction_lists.h"
#include "tree/octree.h"

namespace g3r {

/// Finds the distinct offsets of `lists` and puts the far pairs, which are in no order within a part, into that of InteractionLists::far,
/// with their runs. In parallel over parts; O(pairs).
void sort_far_pairs(const Octree& targets, const Octree& sources, InteractionLists& lists);

}  // namespace g3r
