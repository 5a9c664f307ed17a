// Signs on a graph: what they must be where it leaves no choice, and what the greedy contraction is worth where it does.
#include "orient/sign_graph.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace g3r {
namespace {

// A ring of groups of nodes with random signs, `wrong` of the edges with the wrong one.
struct Ring {
  std::vector<SignEdge> edges;
  std::vector<std::int8_t> sign;
};

Ring ring(std::size_t nodes, std::size_t reach, double wrong, std::uint64_t seed) {
  shapes::Random random(seed);
  Ring out;
  for (std::size_t i = 0; i < nodes; ++i) out.sign.push_back(random.uniform() < 0.5 ? 1 : -1);
  for (std::size_t i = 0; i < nodes; ++i) {
    for (std::size_t k = 1; k <= reach; ++k) {
      const std::size_t j = (i + k) % nodes;
      const double weight = random.uniform(0.5, 1) * out.sign[i] * out.sign[j] * (random.uniform() < wrong ? -1 : 1);
      out.edges.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), weight});
    }
  }
  return out;
}

// The smaller of the shares of nodes with another sign than `truth`, or the opposite one.
double share_wrong(const std::vector<std::int8_t>& sign, const std::vector<std::int8_t>& truth) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < sign.size(); ++i) different += sign[i] != truth[i] ? 1 : 0;
  return static_cast<double>(std::min(different, sign.size() - different)) / static_cast<double>(sign.size());
}

TEST(SignGraph, FindsSignsThatContradictNothing) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Ring graph = ring(2000, 4, 0, seed);
    const Signs found = agree_on_signs(graph.sign.size(), graph.edges);
    EXPECT_EQ(frustration(graph.edges, found.sign), 0);
    EXPECT_EQ(share_wrong(found.sign, graph.sign), 0);
    EXPECT_EQ(std::count(found.component.begin(), found.component.end(), 0U), 2000);
  }
}

// A spanning tree would carry one wrong edge to everything behind it: with 3 % of them to about half of the nodes.
TEST(SignGraph, OutvotesWrongEdges) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Ring graph = ring(2000, 8, 0.03, seed);
    const Signs found = agree_on_signs(graph.sign.size(), graph.edges);
    EXPECT_LE(frustration(graph.edges, found.sign), frustration(graph.edges, graph.sign) * 1.05);
    EXPECT_LT(share_wrong(found.sign, graph.sign), 0.002);
  }
}

TEST(SignGraph, KeepsComponentsApart) {
  const Signs found = agree_on_signs(5, {{0, 2, 1}, {3, 4, -1}});
  EXPECT_EQ(found.component, (std::vector<std::uint32_t>{0, 1, 0, 3, 3}));
  EXPECT_EQ(found.sign[0], found.sign[2]);
  EXPECT_EQ(found.sign[3], -found.sign[4]);
}

TEST(SignGraph, DoesNotDependOnTheOrderOfTheEdges) {
  Ring graph = ring(500, 6, 0.1, 9);
  const Signs forwards = agree_on_signs(graph.sign.size(), graph.edges);
  std::reverse(graph.edges.begin(), graph.edges.end());
  for (SignEdge& edge : graph.edges) std::swap(edge.a, edge.b);
  const Signs backwards = agree_on_signs(graph.sign.size(), graph.edges);
  EXPECT_EQ(forwards.sign, backwards.sign);
}

// The definition, on a matrix of sums: O(N^3). Only which nodes agree is the same, as a group may be turned as a whole.
std::vector<std::int8_t> contracted_by_definition(std::size_t nodes, const std::vector<SignEdge>& edges) {
  std::vector<std::vector<double>> sum(nodes, std::vector<double>(nodes, 0));
  for (const SignEdge& edge : edges) {
    sum[edge.a][edge.b] += edge.weight;
    sum[edge.b][edge.a] += edge.weight;
  }
  std::vector<std::vector<std::size_t>> members(nodes);
  for (std::size_t i = 0; i < nodes; ++i) members[i] = {i};
  std::vector<std::int8_t> sign(nodes, 1);
  for (;;) {
    std::size_t first = 0, second = 0;
    for (std::size_t a = 0; a < nodes; ++a) {
      for (std::size_t b = a + 1; b < nodes; ++b) {
        if (std::abs(sum[a][b]) > std::abs(sum[first][second])) std::tie(first, second) = std::pair(a, b);
      }
    }
    if (sum[first][second] == 0) return sign;
    const std::int8_t turn = sum[first][second] < 0 ? -1 : 1;
    for (const std::size_t i : members[second]) sign[i] = static_cast<std::int8_t>(sign[i] * turn);
    members[first].insert(members[first].end(), members[second].begin(), members[second].end());
    sum[first][second] = sum[second][first] = 0;
    for (std::size_t other = 0; other < nodes; ++other) {
      sum[first][other] += turn * sum[second][other];
      sum[other][first] = sum[first][other];
      sum[second][other] = sum[other][second] = 0;
    }
  }
}

TEST(SignGraph, IsTheGreedyContraction) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Ring graph = ring(60, 7, 0.3, seed);
    const std::vector<std::int8_t> expected = contracted_by_definition(graph.sign.size(), graph.edges);
    EXPECT_EQ(share_wrong(agree_on_signs(graph.sign.size(), graph.edges).sign, expected), 0) << seed;
  }
}

// Two square lattices, of 20 x 20 and of 30 x 30 nodes, and `bridges` edges between them of the given weight.
std::vector<SignEdge> two_lattices(std::uint32_t bridges, double weight = 1) {
  std::vector<SignEdge> edges;
  for (const auto& [first, side] : {std::pair<std::uint32_t, std::uint32_t>{0, 20}, {400, 30}}) {
    for (std::uint32_t i = 0; i < side; ++i) {
      for (std::uint32_t j = 0; j + 1 < side; ++j) {
        edges.push_back({first + i * side + j, first + i * side + j + 1, 1});
        edges.push_back({first + j * side + i, first + (j + 1) * side + i, 1});
      }
    }
  }
  for (std::uint32_t k = 0; k < bridges; ++k) edges.push_back({k, 400 + k, weight});
  return edges;
}

// The bridges, weaker than all else, are all that holds the smaller lattice: its mean degree is d = (4 * 400 - 80 + b / 4) / 400.
TEST(HeldTogether, BridgesHoldByTheRuleOfSuccession) {
  for (const std::uint32_t bridges : {1U, 5U, 20U}) {
    const std::vector<Hold> hold = held_together(1300, two_lattices(bridges, 0.25));
    const double k = 0.25 * bridges / ((1520 + 0.25 * bridges) / 400);
    const double chance = 1 - (1 - k / 20) / (k + 2);
    for (std::size_t i = 0; i < 400; ++i) EXPECT_LE(hold[i].chance, static_cast<float>(chance) + 1e-6F) << i;
    EXPECT_NEAR(hold[210].chance, chance, 1e-6);  // in its middle nothing hangs more loosely
    EXPECT_GT(hold[400 + 465].chance, 0.9F);
  }
}

// Neither contradictions nor nothing hold anything, and one group of nodes is distinguished from the other.
TEST(HeldTogether, ContradictionsHoldNothing) {
  const std::vector<Hold> hold = held_together(1300, two_lattices(20, -1));
  for (std::size_t i = 0; i < 400; ++i) {
    EXPECT_EQ(hold[i].chance, 0.5F) << i;
    EXPECT_EQ(hold[i].group, hold[0].group) << i;
    EXPECT_NE(hold[i].group, 0U) << i;
  }
  EXPECT_EQ(held_together(3, {})[1].chance, 1);  // alone it has the side of all there is
}

TEST(HeldTogether, DoesNotDependOnTheOrderOfTheEdges) {
  std::vector<SignEdge> edges = two_lattices(7);
  const std::vector<Hold> forwards = held_together(1300, edges);
  std::reverse(edges.begin(), edges.end());
  for (SignEdge& edge : edges) std::swap(edge.a, edge.b);
  const std::vector<Hold> backwards = held_together(1300, edges);
  for (std::size_t i = 0; i < 1300; ++i) EXPECT_EQ(forwards[i].chance, backwards[i].chance) << i;
}

TEST(SignGraph, FrustrationIsTheShareOfTheWeightThatIsContradicted) {
  const std::vector<SignEdge> edges{{0, 1, 3}, {1, 2, -1}};
  EXPECT_DOUBLE_EQ(frustration(edges, {1, 1, 1}), 0.25);
  EXPECT_DOUBLE_EQ(frustration(edges, {1, 1, -1}), 0);
  EXPECT_DOUBLE_EQ(frustration({}, {1}), 0);
}

}  // namespace
}  // namespace g3r
