// The arcs across the faces of an octree: loops on the boundary of every leaf, whatever the signs.
#include "mesh/field_arcs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <vector>

#include "mesh/minimal_edges.h"
#include "sanitized.h"

namespace {

using namespace g3r;
using namespace g3r::mesh;

std::vector<CrossingEdge> crossing_edges(const Octree& octree, const std::vector<std::uint8_t>& inside) {
  const auto all = [](std::size_t) { return true; };
  const auto keep = [&](const MinimalEdge& e, std::vector<CrossingEdge>& out) {
    if (inside[e.low] != inside[e.high]) out.push_back({e, inside[e.low] != 0});
  };
  return edges::find_edges<CrossingEdge>(octree, edges::mark_nodes(octree, all), keep, nullptr);
}

// Every corner that may be inside is, once in so many times.
std::vector<std::uint8_t> random_signs(const Octree& octree, std::uint64_t seed) {
  constexpr std::uint64_t kOnceIn = 3;
  std::mt19937_64 rng(seed);
  std::vector<std::uint8_t> inside(octree.corner_count());
  for (std::size_t c = 0; c < inside.size(); ++c) inside[c] = rng() % kOnceIn == 0 && !octree.on_boundary(c) ? 1 : 0;
  return inside;
}

bool any_leaf(std::uint32_t) { return true; }

InsideTest everywhere(std::uint8_t side) {
  return [side](const std::vector<Vec3>& centres) { return std::vector<std::uint8_t>(centres.size(), side); };
}

TEST(FieldArcs, AroundALoneCornerEveryLeafHasOnePatchOfThreeCrossings) {
  const Octree octree({-1, -1, -1}, 2, {}, 2);
  std::vector<std::uint8_t> inside(octree.corner_count(), 0);
  std::size_t lone = 0;
  while (octree.on_boundary(lone)) ++lone;
  inside[lone] = 1;
  const std::vector<CrossingEdge> edges = crossing_edges(octree, inside);
  ASSERT_EQ(edges.size(), 6U);
  Arcs arcs = join_arcs(octree, edges, any_leaf, everywhere(0));
  EXPECT_TRUE(arcs.multiple.empty());
  std::map<std::size_t, std::size_t> patches;
  for (std::size_t place = 0; place < arcs.places.size(); ++place) ++patches[arcs.places.find(place)];
  EXPECT_EQ(patches.size(), 8U);
  for (const auto& [first, size] : patches) EXPECT_EQ(size, 3U) << first;
}

// Where four crossings are on the rim of a face of equal leaves, the corners inside are opposite to each other, and each arc cuts off one
// corner of the side that the centre is not on.
TEST(FieldArcs, CutOffTheCornersThatAreNotOnTheSideOfTheCentre) {
  const Octree octree({-1, -1, -1}, 2, {}, 3);
  const std::vector<std::uint8_t> inside = random_signs(octree, 1);
  const std::vector<CrossingEdge> edges = crossing_edges(octree, inside);
  for (const std::uint8_t side : {std::uint8_t{0}, std::uint8_t{1}}) {
    const Arcs arcs = join_arcs(octree, edges, any_leaf, everywhere(side));
    EXPECT_GT(arcs.multiple.size(), 100U);
    for (const Arc& arc : arcs.multiple) {
      const CrossingEdge &a = edges[edge_of(arc.from)], &b = edges[edge_of(arc.to)];
      const std::uint32_t shared = a.low == b.low || a.low == b.high ? a.low : a.high;
      EXPECT_TRUE(shared == b.low || shared == b.high);
      EXPECT_NE(inside[shared], side);
    }
  }
}

Octree random_octree(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> position(-0.8, 0.8);
  std::vector<RefineDisc> requests;
  for (const int level : {3, 4, 5}) requests.push_back({{position(rng), position(rng), position(rng)}, {}, 0.1, 0, level});
  return Octree({-1, -1, -1}, 2, requests, 2);
}

constexpr std::uint64_t kOctrees = kSanitized ? 10 : 100;

// A patch is bounded by a loop on the boundary of one leaf, through two crossings or more: two around a corner of smaller leaves on an
// edge.
TEST(FieldArcs, JoinNoTwoLeavesAndNoFewerThanTwoCrossings) {
  for (std::uint64_t seed = 0; seed < kOctrees; ++seed) {
    const Octree octree = random_octree(seed);
    const std::vector<CrossingEdge> edges = crossing_edges(octree, random_signs(octree, seed));
    Arcs arcs = join_arcs(octree, edges, any_leaf, everywhere(seed % 2));
    std::vector<std::size_t> crossings(arcs.places.size(), 0);
    for (std::uint32_t place = 0; place < crossings.size(); ++place) {
      const auto first = static_cast<std::uint32_t>(arcs.places.find(place));
      ASSERT_EQ(leaf_at(edges, first), leaf_at(edges, place));
      if (!edges[edge_of(place)].is_repeated(turn_of(place))) ++crossings[first];
    }
    EXPECT_EQ(std::count(crossings.begin(), crossings.end(), std::size_t{1}), 0);
  }
}

// What the other leaves are is nothing to the patches of a leaf whose crossings are all known.
TEST(FieldArcs, OfSomeLeavesAreThoseOfAll) {
  const Octree octree = random_octree(7);
  const std::vector<CrossingEdge> edges = crossing_edges(octree, random_signs(octree, 7));
  const auto some = [](std::uint32_t leaf) { return leaf % 5 == 0; };
  Arcs all = join_arcs(octree, edges, any_leaf, everywhere(1)), part = join_arcs(octree, edges, some, everywhere(1));
  std::size_t compared = 0;
  for (std::uint32_t place = 0; place < all.places.size(); ++place) {
    if (!some(leaf_at(edges, place))) continue;
    EXPECT_EQ(part.places.find(place), all.places.find(place));
    ++compared;
  }
  EXPECT_GT(compared, 100U);
  EXPECT_LT(part.multiple.size(), all.multiple.size());
}

}  // namespace
