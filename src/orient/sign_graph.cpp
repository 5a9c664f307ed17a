#include "orient/sign_graph.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace g3r {
namespace {

// A pair of groups waiting to become one. Of equal ranks the one with the smaller numbers comes first.
struct Contraction {
  double rank;  // the largest comes first
  double sum;
  std::uint32_t a, b;  // a < b
  bool operator<(const Contraction& other) const { return std::make_tuple(rank, other.a, other.b) < std::make_tuple(other.rank, a, b); }
};

// Groups of nodes and the sums of the weights between them.
class Contractor {
 public:
  // kTurned: the largest |sum| comes first, and of groups with a negative one the one that joins is turned. kKept: the largest sum over the
  // number of nodes of the smaller group comes first, so that what a few edges hold comes last, and none is turned.
  enum class Negative { kTurned, kKept };

  Contractor(std::size_t nodes, const std::vector<SignEdge>& edges, Negative negative)
      : members_(nodes), sums_(nodes), turns_(negative == Negative::kTurned) {
    for (std::uint32_t i = 0; i < nodes; ++i) members_[i] = {i};
    for (const SignEdge& edge : edges) {
      if (edge.a == edge.b) continue;
      sums_[edge.a][edge.b] += edge.weight;
      sums_[edge.b][edge.a] += edge.weight;
    }
    std::vector<Contraction> first;
    for (std::uint32_t a = 0; a < nodes; ++a) {
      for (const auto& [b, sum] : sums_[a]) {
        if (a < b) first.push_back(waiting(a, b, sum));
      }
    }
    waiting_ = std::priority_queue<Contraction>(std::less<Contraction>(), std::move(first));
  }

  // For every pair that becomes one: body(nodes of the group that is kept, of the one that joins it, sum of the weights between them).
  template <class Body>
  void run(const Body& body) {
    while (!waiting_.empty()) {
      const Contraction next = waiting_.top();
      waiting_.pop();
      const auto found = sums_[next.a].find(next.b);
      if (found == sums_[next.a].end() || found->second != next.sum) continue;  // the sum has changed since
      const Contraction now = waiting(next.a, next.b, next.sum);
      if (now.rank == next.rank) {
        contract(next, body);
      } else {
        waiting_.push(now);  // the groups have grown since
      }
    }
  }

  // The nodes of every group that is left, under one of them; of the others: none.
  [[nodiscard]] const std::vector<std::vector<std::uint32_t>>& members() const { return members_; }

 private:
  [[nodiscard]] Contraction waiting(std::uint32_t a, std::uint32_t b, double sum) const {
    const auto smaller = static_cast<double>(std::min(members_[a].size(), members_[b].size()));
    return {turns_ ? std::abs(sum) : sum / smaller, sum, std::min(a, b), std::max(a, b)};
  }

  // The group with fewer neighbours joins the other.
  template <class Body>
  void contract(const Contraction& pair, const Body& body) {
    std::uint32_t kept = pair.a;
    std::uint32_t joined = pair.b;
    if (sums_[kept].size() < sums_[joined].size()) std::swap(kept, joined);
    body(members_[kept], members_[joined], pair.sum);
    const bool turned = turns_ && pair.sum < 0;
    sums_[kept].erase(joined);
    members_[kept].insert(members_[kept].end(), members_[joined].begin(), members_[joined].end());
    members_[joined] = {};
    for (const auto& [other, sum] : sums_[joined]) {
      if (other == kept) continue;
      sums_[other].erase(joined);
      const double together = sums_[kept][other] += turned ? -sum : sum;
      sums_[other][kept] = together;
      waiting_.push(waiting(kept, other, together));
    }
    sums_[joined].clear();
  }

  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::unordered_map<std::uint32_t, double>> sums_;  // of the weights between two groups; of groups that have joined: none
  bool turns_;
  std::priority_queue<Contraction> waiting_;
};

}  // namespace

Signs agree_on_signs(std::size_t nodes, const std::vector<SignEdge>& edges) {
  Signs out{std::vector<std::int8_t>(nodes, 1), std::vector<std::uint32_t>(nodes)};
  Contractor contractor(nodes, edges, Contractor::Negative::kTurned);
  contractor.run([&](const std::vector<std::uint32_t>&, const std::vector<std::uint32_t>& joined, double sum) {
    if (sum >= 0) return;
    for (const std::uint32_t i : joined) out.sign[i] = static_cast<std::int8_t>(-out.sign[i]);
  });
  for (const std::vector<std::uint32_t>& group : contractor.members()) {
    const std::uint32_t least = group.empty() ? 0 : *std::min_element(group.begin(), group.end());
    for (const std::uint32_t i : group) out.component[i] = least;
  }
  return out;
}

std::vector<Hold> held_together(std::size_t nodes, const std::vector<SignEdge>& edges) {
  std::vector<double> degree(nodes, 0);  // of the nodes of a group together, under its first node
  std::vector<double> rim(nodes, 0);
  for (const SignEdge& edge : edges) {
    if (edge.a == edge.b) continue;
    for (const std::uint32_t i : {edge.a, edge.b}) {
      degree[i] += std::abs(edge.weight);
      rim[i] += edge.weight;
    }
  }
  std::vector<Hold> hold(nodes);
  std::uint32_t groups = 0;
  Contractor contractor(nodes, edges, Contractor::Negative::kKept);
  contractor.run([&](const std::vector<std::uint32_t>& kept, const std::vector<std::uint32_t>& joined, double sum) {
    const std::vector<std::uint32_t>& smaller = kept.size() < joined.size() ? kept : joined;
    const auto size = static_cast<double>(smaller.size());
    const double node = degree[smaller.front()] / size;
    const double holds = node > 0 ? std::clamp(rim[smaller.front()] / node, 0.0, std::sqrt(size)) : 0;
    const auto chance = static_cast<float>(1 - (1 - holds / std::sqrt(size)) / (holds + 2));
    ++groups;
    for (const std::uint32_t i : smaller) {
      if (chance < hold[i].chance) hold[i] = {chance, groups};
    }
    degree[kept.front()] += degree[joined.front()];
    rim[kept.front()] += rim[joined.front()] - 2 * sum;
  });
  return hold;
}

double frustration(const std::vector<SignEdge>& edges, const std::vector<std::int8_t>& sign) {
  double all = 0;
  double contradicted = 0;
  for (const SignEdge& edge : edges) {
    all += std::abs(edge.weight);
    if (edge.weight * sign[edge.a] * sign[edge.b] < 0) contradicted += std::abs(edge.weight);
  }
  return all > 0 ? contradicted / all : 0;
}

}  // namespace g3r
