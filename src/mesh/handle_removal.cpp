#include "mesh/handle_removal.h"

#include "cloud/constants.h"
#include "mesh/constants.h"

#include <g3r/error.h>

#include <algorithm>
#include <utility>

namespace g3r::mesh {
namespace {

// How many different values each group has; most have one.
class DifferentValues {
 public:
  explicit DifferentValues(std::size_t groups) : first_(groups, kNone), count_(groups, 0) {}

  void add(std::uint32_t group, std::uint32_t value) {
    if (first_[group] == kNone) {
      first_[group] = value;
      count_[group] = 1;
    } else if (first_[group] != value) {
      further_.emplace_back(group, value);
    }
  }

  std::vector<long> count() {
    std::sort(further_.begin(), further_.end());
    further_.erase(std::unique(further_.begin(), further_.end()), further_.end());
    for (const auto& [group, value] : further_) ++count_[group];
    return std::move(count_);
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<long> count_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> further_;
};

// The patches in the leaves around open edges.
Patches patches_now(const Octree& octree, const OpenEdges& open, const std::vector<std::uint8_t>& inside, const InsideTest& centre) {
  std::vector<std::uint32_t> crossing;
  for (std::uint32_t k = 0; k < open.edges.size(); ++k) {
    if (inside[open.edges[k].low] != inside[open.edges[k].high]) crossing.push_back(k);
  }
  return patches_in(
      octree, open.edges, crossing, [&](std::uint32_t leaf) { return open.around.contains(leaf); }, inside, centre);
}

}  // namespace

HandleRemoval::HandleRemoval(const Octree& octree, const std::vector<std::uint8_t>& open, const std::vector<std::uint8_t>& inside,
                             DualSurface surface, InsideTest centre_inside, HeldTest held, double most_per_handle,
                             const std::atomic<bool>* cancel)
    : octree_(octree),
      centre_inside_(std::move(centre_inside)),
      held_(std::move(held)),
      most_per_handle_(most_per_handle),
      cancel_(cancel),
      handles_(count_handles(surface)),
      elsewhere_(surface_elsewhere(leaves_around(octree, open, cancel), std::move(surface))),
      open_(open_edges(octree, open, elsewhere_.around, cancel)),
      surface_(open_, elsewhere_, patches_now(octree, open_, inside, centre_inside_)),
      grouping_(open_) {}

// In the leaves of the groups.
Patches HandleRemoval::patches_around(const CornerGroups& groups, const std::vector<std::uint8_t>& inside) const {
  std::vector<std::uint8_t> marked(open_.around.count(), 0), seen(open_.edges.size(), 0);
  std::vector<std::uint32_t> crossing;
  for (const std::uint32_t leaf : groups.leaves) {
    marked[leaf] = 1;
    for (const std::uint32_t edge : open_.around_leaf.of(leaf)) {
      if (seen[edge] != 0 || inside[open_.edges[edge].low] == inside[open_.edges[edge].high]) continue;
      seen[edge] = 1;
      crossing.push_back(edge);
    }
  }
  const auto is_marked = [&](std::uint32_t leaf) { return open_.around.contains(leaf) && marked[open_.around.number(leaf)] != 0; };
  return patches_in(octree_, open_.edges, crossing, is_marked, inside, centre_inside_);
}

std::vector<HandleRemoval::Change> HandleRemoval::changes_of(const CornerGroups& groups, const Patches& changed,
                                                             const std::vector<std::uint8_t>& from,
                                                             const std::vector<std::uint8_t>& to) const {
  std::vector<Change> change(groups.count());
  DifferentValues components(groups.count());
  const Patches& now = surface_.patches();
  for (std::size_t p = 0; p < now.leaf.size(); ++p) {
    const std::uint32_t g = grouping_.at(now.leaf[p]);
    if (g == kNone) continue;
    change[g].twice_chi -= twice_characteristic(now, p);
    components.add(g, surface_.of(p));
  }
  for (std::size_t p = 0; p < changed.leaf.size(); ++p) change[grouping_.at(changed.leaf[p])].twice_chi += twice_characteristic(changed, p);
  // Crossings are the faces.
  const auto crosses = [](const MinimalEdge& e, const std::vector<std::uint8_t>& inside) {
    return inside[e.low] != inside[e.high] ? 1 : 0;
  };
  for (std::size_t k = 0; k < groups.place.size(); ++k) {
    const std::uint32_t corner = open_.corners[groups.place[k]];
    for (const std::uint32_t edge : open_.at_corner.of(groups.place[k])) {
      const MinimalEdge& e = open_.edges[edge];
      const bool counted = e.high == corner && from[e.low] != to[e.low];  // with the other end
      if (!counted) change[groups.of[k]].twice_chi += 2 * (crosses(e, to) - crosses(e, from));
    }
  }
  if (held_) count_bare(groups, from, to, change);
  const std::vector<long> before = components.count();
  for (std::size_t g = 0; g < change.size(); ++g) change[g].components = before[g];
  return change;
}

// At the corners of groups that cut tubes.
void HandleRemoval::count_bare(const CornerGroups& groups, const std::vector<std::uint8_t>& from, const std::vector<std::uint8_t>& to,
                               std::vector<Change>& change) const {
  const auto bare = [&](const MinimalEdge& e, const std::vector<std::uint8_t>& inside) {
    if (inside[e.low] == inside[e.high]) return 0;
    const Vec3 low = octree_.corner_position(e.low), high = octree_.corner_position(e.high);
    return (inside[e.low] != 0 ? held_(low, high) : held_(high, low)) ? 0 : 1;
  };
  for (std::size_t k = 0; k < groups.place.size(); ++k) {
    Change& of = change[groups.of[k]];
    if (!is_worth(of.tubes_cut(), groups.size[groups.of[k]])) continue;
    for (const std::uint32_t edge : open_.at_corner.of(groups.place[k])) {
      const MinimalEdge& e = open_.edges[edge];
      if (e.high == open_.corners[groups.place[k]] && from[e.low] != to[e.low]) continue;  // counted with the other end
      of.bare_now += bare(e, from);
      of.bare_then += bare(e, to);
    }
  }
}

bool HandleRemoval::Change::is_held_better() const {
  return bare_now > 0 && static_cast<double>(bare_now) >= kMostOf * static_cast<double>(bare_now + bare_then);
}

// The handles that a change is worth if so many components pass through its leaves afterwards.
long HandleRemoval::worth(const Change& change, long after) const {
  const long lost = change.handles_lost(after);
  return lost == 0 && change.is_held_better() ? change.tubes_cut() : lost;
}

// Whether some group can be worth it: no handle is lost without a gain but by joining components.
bool HandleRemoval::can_lose(const CornerGroups& groups, const Patches& changed, const std::vector<Change>& change) const {
  std::vector<long> least(change.size(), 0);  // components afterwards
  for (const std::uint32_t leaf : changed.leaf) least[grouping_.at(leaf)] = 1;
  for (std::size_t g = 0; g < change.size(); ++g) {
    if (is_worth(change[g].handles_lost(least[g]), groups.size[g])) return true;
    if (change[g].is_held_better() && is_worth(change[g].tubes_cut(), groups.size[g])) return true;
  }
  return false;
}

// Marks the groups that lose handles by the proposal while all the marked ones take it. Groups only lose their marks, so the rounds end.
std::vector<std::uint8_t> HandleRemoval::choose(const CornerGroups& groups, const Patches& changed,
                                                const std::vector<Change>& change) const {
  if (!can_lose(groups, changed, change)) return std::vector<std::uint8_t>(change.size(), 0);
  const TriedExchange tried(surface_, changed, [this](std::uint32_t leaf) { return grouping_.at(leaf) != kNone; });
  std::vector<std::uint8_t> take(change.size(), 1);
  for (bool steady = false; !steady && std::find(take.begin(), take.end(), 1) != take.end();) {
    const std::vector<std::uint32_t> component = tried.components([&](std::uint32_t leaf) { return take[grouping_.at(leaf)] != 0; });
    DifferentValues components(take.size());
    for (std::size_t p = 0; p < component.size(); ++p) {
      if (component[p] != kNone) components.add(grouping_.at(changed.leaf[p]), component[p]);
    }
    const std::vector<long> after = components.count();
    steady = true;
    for (std::size_t g = 0; g < take.size(); ++g) {
      if (take[g] == 0) continue;
      take[g] = is_worth(worth(change[g], after[g]), groups.size[g]) ? 1 : 0;
      steady = steady && take[g] != 0;
    }
  }
  return take;
}

bool HandleRemoval::propose(const std::vector<std::uint8_t>& proposal, std::vector<std::uint8_t>& inside) {
  if (cancel_ != nullptr && cancel_->load()) throw Cancelled();
  const CornerGroups groups = grouping_.group(proposal, inside, [this](long corners) { return is_worth(handles_ + 1, corners); });
  if (groups.count() == 0) return false;
  std::vector<std::uint8_t> next = inside;
  for (const std::uint32_t i : groups.place) next[open_.corners[i]] = proposal[open_.corners[i]];
  const Patches changed = patches_around(groups, next);
  const std::vector<Change> change = changes_of(groups, changed, inside, next);
  const std::vector<std::uint8_t> take = choose(groups, changed, change);
  const bool any = std::find(take.begin(), take.end(), 1) != take.end();
  if (any) {
    for (std::size_t k = 0; k < groups.place.size(); ++k) {
      if (take[groups.of[k]] != 0) inside[open_.corners[groups.place[k]]] = proposal[open_.corners[groups.place[k]]];
    }
    long twice_chi = 0;
    for (std::size_t g = 0; g < take.size(); ++g) twice_chi += take[g] != 0 ? change[g].twice_chi : 0;
    const auto components = static_cast<long>(surface_.count());
    surface_.exchange(changed, [&](std::uint32_t leaf) { return grouping_.at(leaf) != kNone && take[grouping_.at(leaf)] != 0; });
    handles_ += handles_of(static_cast<long>(surface_.count()) - components, twice_chi);
  }
  grouping_.end(groups, take);
  return any;
}

}  // namespace g3r::mesh
