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

struct Signs {
  std::vector<std::int8_t> sign;         ///< N: 1 or -1
  std::vector<std::uint32_t> component;  ///< N: smallest node of the connected component; signs of different ones are unrelated
};

/// Signs s_i that make sum w_ij s_i s_j over all edges large, which is Z2 synchronisation (max-cut; NP-hard), by greedy additive edge
/// contraction: the two groups with the largest |sum of the weights between them| become one, the smaller group turned if the sum is
/// negative, and the sums of the new group are those of both (Keuper et al., "Efficient decomposition of image and mesh graphs by lifted
/// multicuts", ICCV 2015; for orientation the same graph as in Hoppe et al. 1992, whose spanning tree trusts single edges where this asks
/// all edges between two groups). Ties go to the smaller nodes, so the result does not depend on the order of the edges; parallel edges
/// add up. `nodes` = N. O(E log E).
[[nodiscard]] Signs agree_on_signs(std::size_t nodes, const std::vector<SignEdge>& edges);

/// Share of the weight that the signs contradict: sum of |w_ij| with w_ij s_i s_j < 0 over sum |w_ij|; 0 without edges. O(E).
[[nodiscard]] double frustration(const std::vector<SignEdge>& edges, const std::vector<std::int8_t>& sign);

}  // namespace g3r
