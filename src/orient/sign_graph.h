// Signs of unoriented normals by agreement along the edges of a graph.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Two nodes and how much they want the same sign (weight > 0) or opposite ones (weight < 0).
struct SignEdge {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  double weight = 0;
};

/// A sign for each of N nodes.
struct Signs {
  std::vector<std::int8_t> sign;         ///< N: 1 or -1
  std::vector<std::uint32_t> component;  ///< N: smallest node of the connected component; signs of different ones are unrelated
};

/// Signs s_i that make sum w_ij s_i s_j over all edges large, which is Z2 synchronisation (max-cut; NP-hard), by greedy additive edge
/// contraction: the two groups with the largest |sum of the weights between them| become one, the group with fewer neighbours turned if the
/// sum is negative, and the sums of the new group are those of both (Keuper et al., "Efficient decomposition of image and mesh graphs by
/// lifted multicuts", ICCV 2015; for orientation the same graph as in Hoppe et al. 1992, whose spanning tree trusts single edges where this
/// asks all edges between two groups). Ties go to the smaller nodes, so the result does not depend on the order of the edges; parallel
/// edges add up. `nodes` = N. O(E log E).
[[nodiscard]] Signs agree_on_signs(std::size_t nodes, std::vector<SignEdge> edges);

/// How surely a node has the side of the rest of its component.
struct Hold {
  float chance = 1;         ///< 1/2..1
  std::uint32_t group = 0;  ///< number of the group of nodes, its own among them, that hangs together with the rest no more surely; 0: none
};

/// What edges to be judged say of it: weight > 0 where the sides of two nodes agree, < 0 where they contradict each other. Groups of nodes
/// become one, none being turned, the largest sum of weights over the number of nodes of the smaller one first. Whenever one of n nodes
/// joins a larger one, all that holds it is its rim: the sum c of the weights between its nodes and all others. A compact patch of n nodes
/// of the mean degree d (sum of |w| of a node) has a rim of d sqrt(n), as a square on a lattice has. With k = c / d nodes' worth of rim
/// that holds, and the share m = 1 - k / sqrt(n) that is missing, the chance is 1 - m / (k + 2): the rule of succession (Laplace 1774) for
/// k observations that agree, as far as there could be more. It is a half where nothing holds a group, and 1 where its rim is whole. A node
/// has the least chance of the groups that it was in. O(E log E).
[[nodiscard]] std::vector<Hold> held_together(std::size_t nodes, std::vector<SignEdge> edges);

/// Share of the weight that the signs contradict: sum of |w_ij| with w_ij s_i s_j < 0 over sum |w_ij|; 0 without edges. O(E).
[[nodiscard]] double frustration(const std::vector<SignEdge>& edges, const std::vector<std::int8_t>& sign);

}  // namespace g3r
