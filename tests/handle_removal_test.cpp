// Handles go where another labelling of the signs has none; nothing is split for it.
#include "mesh/handle_removal.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "mesh_topology.h"

namespace {

using namespace g3r;
using namespace g3r::mesh;
using g3r::testing::topology;
using g3r::testing::Topology;
using Marks = std::vector<std::uint8_t>;

const Octree& grid() {
  static const Octree octree({-1, -1, -1}, 2, {}, 4);
  return octree;
}

TEST(SomeLeaves, AreNumberedInTheirOrder) {
  Marks marked(300, 0);
  for (const std::size_t leaf : {0U, 1U, 63U, 64U, 130U, 299U}) marked[leaf] = 1;
  const SomeLeaves some(marked);
  std::uint32_t number = 0;
  for (std::uint32_t leaf = 0; leaf < marked.size(); ++leaf) {
    ASSERT_EQ(some.contains(leaf), marked[leaf] != 0);
    if (marked[leaf] == 0) continue;
    ASSERT_EQ(some.number(leaf), number++);
  }
  EXPECT_EQ(some.count(), number);
}

// The places of the corners follow from the leaves that have them.
TEST(Octree, EveryLeafHasItsCornersWhereItEnds) {
  const Octree octree({0, 0, 0}, 1, {RefineDisc{{0.3, 0.4, 0.2}, {0, 0, 1}, 0.1, 0.05, 6}}, 2);
  for (std::size_t leaf = 0; leaf < octree.leaf_count(); ++leaf) {
    const OctreeNode node = octree.leaf(leaf);
    for (std::uint32_t place = 0; place < 8; ++place) {
      const std::array<std::uint32_t, 3> grid = octree.corner_grid(octree.corner(leaf, place));
      for (std::size_t a = 0; a < 3; ++a) ASSERT_EQ(grid[a], node.low[a] + ((place >> a) & 1U) * octree.extent(node));
    }
  }
}

Marks mark(const std::function<bool(const Vec3&)>& inside) {
  Marks out(grid().corner_count());
  for (std::size_t c = 0; c < out.size(); ++c) out[c] = inside(grid().corner_position(c)) && !grid().on_boundary(c) ? 1 : 0;
  return out;
}

Marks no_centres(const std::vector<Vec3>& centres) { return Marks(centres.size(), 0); }

Topology topology_after(Marks inside, const Marks& proposal, const HeldTest& held = {}) {
  DualSurface surface = contour(grid(), inside, no_centres);
  Marks open(inside.size(), 0);
  for (std::size_t c = 0; c < open.size(); ++c) open[c] = inside[c] != proposal[c] ? 1 : 0;
  HandleRemoval removal(grid(), open, inside, surface, no_centres, held);
  if (removal.propose(proposal, inside)) surface = contour(grid(), inside, no_centres);
  EXPECT_EQ(removal.handles(), count_handles(surface));
  std::vector<Vec3> positions;
  for (std::size_t p = 0; p < surface.patch_count() + surface.midpoints.size(); ++p) positions.push_back({0, 0, static_cast<double>(p)});
  return topology(triangulate(surface, std::move(positions), {}));
}

bool ball(const Vec3& p) { return std::hypot(p[0], p[1], p[2]) < 0.7; }
bool ring(const Vec3& p) { return std::hypot(std::hypot(p[0], p[1]) - 0.6, p[2]) < 0.2; }
bool on_axis(const Vec3& p) { return std::hypot(p[0], p[1]) < 0.06; }

TEST(HandleRemoval, ATunnelOfDoubtfulCornersIsFilled) {
  const Marks drilled = mark([](const Vec3& p) { return ball(p) && !on_axis(p); });
  EXPECT_EQ(topology_after(drilled, drilled).genus, 1);
  EXPECT_EQ(topology_after(drilled, mark(ball)).genus, 0);
}

TEST(HandleRemoval, ABridgeOfDoubtfulCornersIsCut) {
  const auto bridged =
      mark([](const Vec3& p) { return ring(p) || (std::abs(p[1]) < 0.06 && std::abs(p[2]) < 0.06 && std::abs(p[0]) < 0.6); });
  EXPECT_EQ(topology_after(bridged, bridged).genus, 2);
  const Topology cut = topology_after(bridged, mark(ring));
  EXPECT_EQ(cut.genus, 1);
  EXPECT_EQ(cut.components, 1U);
}

TEST(HandleRemoval, CutsThatSplitAPartAreNotMade) {
  const Marks whole = mark(ring);
  const Marks cut_twice = mark([](const Vec3& p) { return ring(p) && std::abs(p[0]) > 0.06; });
  const Topology kept = topology_after(whole, cut_twice);
  EXPECT_EQ(kept.genus, 1);
  EXPECT_EQ(kept.components, 1U);
}

// The true surface: crossings between a place inside of it and one outside are held.
HeldTest held_by(const std::function<bool(const Vec3&)>& inside) {
  return [=](const Vec3& within, const Vec3& outside) { return inside(within) && !inside(outside); };
}

// A solid with a cavity, and a hole from there to the outside: one sphere, of which filling the hole makes two.
bool hollow(const Vec3& p) { return ball(p) && std::hypot(p[0], p[1], p[2]) > 0.45; }

TEST(HandleRemoval, TheOnlyHoleInAWallIsFilledWherePointsHoldTheWall) {
  const Marks drilled = mark([](const Vec3& p) { return hollow(p) && !(on_axis(p) && p[2] > 0); });
  EXPECT_EQ(topology_after(drilled, mark(hollow), held_by(hollow)).components, 2U);
  EXPECT_EQ(topology_after(drilled, mark(hollow)).components, 1U);
  const auto all_drilled = mark([](const Vec3& p) { return hollow(p) && !on_axis(p); });
  EXPECT_EQ(topology_after(all_drilled, all_drilled).genus, 1);
  const Topology filled = topology_after(all_drilled, mark(hollow), held_by(hollow));
  EXPECT_EQ(filled.genus, 0);
  EXPECT_EQ(filled.components, 2U);
}

// Two parts, and a bar between them: a neck if points hold it, else a bridge over a gap.
TEST(HandleRemoval, TheOnlyBarBetweenTwoPartsIsCutUnlessPointsHoldIt) {
  const auto parts = [](const Vec3& p) { return ring(p) && std::abs(p[0]) > 0.2; };
  const auto joined = [&](const Vec3& p) {
    return parts(p) || (ring(p) && p[1] > 0 && std::abs(p[1] - 0.6) < 0.06 && std::abs(p[2]) < 0.06);
  };
  EXPECT_EQ(topology_after(mark(joined), mark(parts), held_by(parts)).components, 2U);
  EXPECT_EQ(topology_after(mark(joined), mark(parts), held_by(joined)).components, 1U);
}

TEST(HandleRemoval, ALargeHandleStaysWhateverIsProposed) {
  EXPECT_EQ(topology_after(mark(ring), mark([](const Vec3& p) { return std::hypot(p[0], p[1]) < 0.8 && std::abs(p[2]) < 0.2; })).genus, 1);
}

TEST(HandleRemoval, SpuriousComponentsAreNeitherGainNorLoss) {
  const Marks drilled = mark([](const Vec3& p) { return ball(p) && !on_axis(p); });
  Marks labelled = drilled;  // the tunnel stays, a bubble in its wall is added
  for (std::size_t c = 0; c < labelled.size(); ++c) {
    const Vec3 p = grid().corner_position(c);
    if (p == Vec3{0.375, 0, 0}) labelled[c] = 0;
  }
  ASSERT_NE(labelled, drilled);
  const Topology t = topology_after(drilled, labelled);
  EXPECT_EQ(t.genus, 1);
  EXPECT_EQ(t.components, 1U);
}

// Signs of a random smooth function on an octree with leaves of several sizes, read at several levels one after the other.
TEST(HandleRemoval, CountsTheHandlesOfTheSurfaceAfterEveryProposal) {
  const RefineDisc ball{{0.2, 0.1, 0}, {0, 0, 0}, 0.5, 0, 5};
  const Octree octree({-1, -1, -1}, 2, {ball}, 4);
  long before = 0, after = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> phase(0, 2 * M_PI);
    std::array<double, 6> p{};
    for (double& a : p) a = phase(random);
    std::vector<double> value(octree.corner_count());
    Marks open(value.size(), 0);
    for (std::size_t c = 0; c < value.size(); ++c) {
      const Vec3 x = octree.corner_position(c);
      value[c] = std::sin(9 * x[0] + p[0]) + std::sin(9 * x[1] + p[1]) + std::sin(9 * x[2] + p[2]) + 0.5 * std::sin(23 * x[0] + p[3]) +
                 0.5 * std::sin(23 * x[1] + p[4]) + 0.5 * std::sin(23 * x[2] + p[5]);
      open[c] = std::abs(value[c]) < 0.5 && !octree.on_boundary(c) ? 1 : 0;
    }
    const auto read = [&](double level) {
      Marks out(value.size());
      for (std::size_t c = 0; c < out.size(); ++c) out[c] = value[c] > (open[c] != 0 ? level : 0) && !octree.on_boundary(c) ? 1 : 0;
      return out;
    };
    Marks inside = read(0);
    const DualSurface surface = contour(octree, inside, no_centres);
    HandleRemoval removal(octree, open, inside, surface, no_centres, {});
    long handles = count_handles(surface);
    before += handles;
    for (const double level : {0.1, -0.1, 0.3, -0.3, 0.1, 0.45}) {
      const bool changed = removal.propose(read(level), inside);
      ASSERT_EQ(removal.handles(), count_handles(contour(octree, inside, no_centres)));
      if (changed) {
        ASSERT_LT(removal.handles(), handles);
      } else {
        ASSERT_EQ(removal.handles(), handles);
      }
      handles = removal.handles();
    }
    after += handles;
  }
  EXPECT_LT(after, before);
}

}  // namespace
