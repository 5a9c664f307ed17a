#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cloud/morton.h"
#include "shapes.h"
#include "sum/target_shells.h"
#include "tree/interaction_lists.h"
#include "tree/octree.h"
#include "tree/tree_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

namespace g3r {
namespace {

constexpr std::size_t kLeafPoints = 10;

// A torus, a dense clump and a far point: levels differ.
CanonicalCloud uneven_cloud() {
  shapes::Random random(2);
  std::vector<Vec3> points = shapes::torus(2000, 0.6, 0.25, 3).points;
  for (int i = 0; i < 300; ++i) points.push_back({0.5 + 1e-4 * random.gaussian(), 1e-4 * random.gaussian(), 0.1});
  points.push_back({3, 3, 3});
  return canonical_cloud(points);
}

Octree octree_of(const CanonicalCloud& cloud) { return build_octree(cloud.points(), morton_codes(cloud.points()), {0.01}, kLeafPoints); }

TEST(Octree, NodesHoldThePointsOfTheirCubesAndLeavesFew) {
  const CanonicalCloud cloud = uneven_cloud();
  const Octree tree = octree_of(cloud);
  for (const OctreeNode& node : tree.nodes) {
    const Vec3 centre = node.centre();
    for (std::size_t p = node.begin; p < node.end; ++p) {
      for (std::size_t a = 0; a < 3; ++a) ASSERT_LE(std::abs(cloud.points()[p][a] - centre[a]), node.half_side());
    }
    if (node.leaf()) {
      EXPECT_LE(node.count(), kLeafPoints);
      continue;
    }
    std::uint32_t begin = node.begin;  // children follow one another and leave no point out
    for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
      EXPECT_EQ(tree.nodes[c].begin, begin);
      EXPECT_GT(tree.nodes[c].count(), 0U);
      begin = tree.nodes[c].end;
    }
    EXPECT_EQ(begin, node.end);
  }
}

TEST(Octree, KnowsTheFarthestPointAndTheWidestKernelOfANode) {
  const CanonicalCloud cloud = uneven_cloud();
  shapes::Random random(4);
  std::vector<double> widths(cloud.size());
  for (double& w : widths) w = random.uniform(0.001, 0.1);
  for (const OctreeNode& node : build_octree(cloud.points(), morton_codes(cloud.points()), widths, kLeafPoints).nodes) {
    double radius = 0, width = 0;
    for (std::size_t p = node.begin; p < node.end; ++p) {
      radius = std::max(radius, vector::length(vector::subtract(cloud.points()[p], node.centre())));
      width = std::max(width, widths[p]);
    }
    EXPECT_NEAR(node.radius, radius, 1e-14);
    EXPECT_EQ(node.width, width);
  }
}

TEST(Octree, TheCubeOfAQueryDependsOnNoOther) {
  const CanonicalCloud cloud = uneven_cloud();
  const Octree guide = octree_of(cloud);
  const auto leaf_cube = [](const Octree& tree, std::size_t query) {
    const auto of_query = [&](std::uint32_t leaf) { return tree.nodes[leaf].begin <= query && query < tree.nodes[leaf].end; };
    const OctreeNode& leaf = tree.nodes[*std::find_if(tree.leaves.begin(), tree.leaves.end(), of_query)];
    return std::tuple(leaf.level, leaf.cell, leaf.radius);
  };
  const Octree all = build_query_octree(cloud.points(), morton_codes(cloud.points()), guide);
  for (std::size_t q = 0; q < cloud.size(); q += 97) {
    const Octree alone = build_query_octree({cloud.points()[q]}, {morton_code(cloud.points()[q])}, guide);
    EXPECT_EQ(leaf_cube(alone, 0), leaf_cube(all, q));
  }
}

TEST(TreeParts, HoldEveryNodeOnceAndFewPoints) {
  const CanonicalCloud cloud = uneven_cloud();
  const Octree tree = octree_of(cloud);
  for (const std::size_t points : {std::size_t{1}, std::size_t{100}, cloud.size()}) {
    const TreeParts parts = cut_tree(tree, points);
    std::set<std::pair<std::uint32_t, std::uint32_t>> places;  // nodes above the subtrees are numbered together
    for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
      ASSERT_LT(parts.part_of[i], parts.size());
      const auto subtrees = static_cast<std::uint32_t>(parts.roots.size());
      EXPECT_TRUE(places.emplace(std::min(parts.part_of[i], subtrees), parts.slot[i]).second) << i;
    }
    for (const std::uint32_t root : parts.roots) EXPECT_TRUE(tree.nodes[root].count() <= points || tree.nodes[root].leaf());
  }
}

TEST(FarPairs, AscendByOffsetAndTargetWithinAPart) {
  const CanonicalCloud cloud = uneven_cloud();
  const Octree tree = octree_of(cloud);
  const InteractionLists lists = build_interaction_lists(tree, tree, 0.7, 5);
  EXPECT_TRUE(std::is_sorted(lists.offsets.begin(), lists.offsets.end()));
  ASSERT_EQ(lists.run_begin.back(), lists.runs.size());
  std::size_t pair = 0;
  for (std::size_t part = 0; part < lists.parts.size(); ++part) {
    ASSERT_EQ(pair, lists.far_begin[part]);
    for (std::size_t run = lists.run_begin[part]; run < lists.run_begin[part + 1]; ++run) {
      if (run > lists.run_begin[part]) {
        EXPECT_LT(lists.runs[run - 1].offset, lists.runs[run].offset);
      }
      const Offset& offset = lists.offsets[lists.runs[run].offset];
      for (std::uint32_t k = 0; k < lists.runs[run].pairs; ++k, ++pair) {
        const OctreeNode& target = tree.nodes[lists.far[pair].target];
        const Vec3 to = offset.to_source(static_cast<std::size_t>(target.level)), source = tree.nodes[lists.far[pair].source].centre();
        for (std::size_t a = 0; a < 3; ++a) ASSERT_EQ(target.centre()[a] + to[a], source[a]);
        if (k > 0) {
          ASSERT_LT(lists.far[pair - 1].target, lists.far[pair].target);
        }
      }
    }
  }
  EXPECT_EQ(pair, lists.far.size());
}

TEST(TargetShells, AreCubesOfTwiceTheSize) {
  constexpr double kWidth = 0.01;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> targets{{0, 1, 0}, {1.5, 0, 0}, {0, 0, -3}, {nan, 0, 0}, {1e9, 0, 0}};
  const auto members = target_shells::members(targets, kWidth, true);
  for (std::uint32_t shell = 0; shell < 3; ++shell) EXPECT_EQ(members[shell], (std::vector<std::uint32_t>{shell}));
  EXPECT_EQ(members[target_shells::kNoShell], (std::vector<std::uint32_t>{3, 4}));
  EXPECT_EQ(target_shells::members(targets, kWidth, false)[target_shells::kNoShell].size(), 4U);
}

}  // namespace
}  // namespace g3r
