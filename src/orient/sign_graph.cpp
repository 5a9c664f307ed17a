#include "orient/sign_graph.h"

#include "orient/pair_sums.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <tuple>
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

// Groups of nodes and the sums of the weights between them. A group is known by one of its nodes.
class Contractor {
 public:
  // kTurned: the largest |sum| comes first, and of groups with a negative one the one that joins is turned. kKept: the largest sum over the
  // number of nodes of the smaller group comes first, so that what a few edges hold comes last, and none is turned.
  enum class Negative { kTurned, kKept };

  // Gives back the edges before the pairs take their memory.
  Contractor(std::size_t nodes, std::vector<SignEdge> edges, Negative negative)
      : members_(nodes), others_(nodes), degree_(nodes, 0), sums_(edges.size()), turns_(negative == Negative::kTurned) {
    for (std::uint32_t i = 0; i < nodes; ++i) members_[i] = {i};
    for (const SignEdge& edge : edges) {
      if (edge.a != edge.b) add(edge.a, edge.b, edge.weight);
    }
    first_.reserve(edges.size());
    std::vector<SignEdge>().swap(edges);
    sums_.for_each([&](std::uint32_t a, std::uint32_t b, double sum) { first_.push_back(waiting(a, b, sum)); });
    std::sort(first_.begin(), first_.end());
  }

  // For every pair that becomes one, before it does: body(group that is kept, group that joins it, sum of the weights between them).
  template <class Body>
  void run(const Body& body) {
    while (!first_.empty() || !waiting_.empty()) {
      const Contraction next = take();
      const double* sum = sums_.find(next.a, next.b);
      if (sum == nullptr || *sum != next.sum) continue;  // it has changed since
      const Contraction now = waiting(next.a, next.b, next.sum);
      if (now.rank == next.rank) {
        contract(next, body);
      } else {
        waiting_.push(now);  // the groups have grown since
      }
    }
  }

  // The nodes of a group; of one that has joined another: none.
  [[nodiscard]] const std::vector<std::uint32_t>& members(std::uint32_t group) const { return members_[group]; }

 private:
  [[nodiscard]] Contraction waiting(std::uint32_t a, std::uint32_t b, double sum) const {
    const auto smaller = static_cast<double>(std::min(members_[a].size(), members_[b].size()));
    return {turns_ ? std::abs(sum) : sum / smaller, sum, std::min(a, b), std::max(a, b)};
  }

  // The pair that comes next.
  Contraction take() {
    const bool is_first = waiting_.empty() || (!first_.empty() && waiting_.top() < first_.back());
    const Contraction next = is_first ? first_.back() : waiting_.top();
    is_first ? first_.pop_back() : waiting_.pop();
    return next;
  }

  // Adds to the sum of two groups, and returns it.
  double add(std::uint32_t a, std::uint32_t b, double weight) {
    if (double* sum = sums_.find(a, b)) return *sum += weight;
    sums_.add(a, b, weight);
    for (const auto& [group, other] : {std::pair(a, b), std::pair(b, a)}) {
      others_[group].push_back(other);
      ++degree_[group];
    }
    return weight;
  }

  void remove(std::uint32_t a, std::uint32_t b) {
    sums_.remove(a, b);
    --degree_[a];
    --degree_[b];
  }

  // The group with fewer neighbours joins the other.
  template <class Body>
  void contract(const Contraction& pair, const Body& body) {
    std::uint32_t kept = pair.a;
    std::uint32_t joined = pair.b;
    if (degree_[kept] < degree_[joined]) std::swap(kept, joined);
    body(kept, joined, pair.sum);
    const bool turned = turns_ && pair.sum < 0;
    if (members_[kept].size() < members_[joined].size()) members_[kept].swap(members_[joined]);
    members_[kept].insert(members_[kept].end(), members_[joined].begin(), members_[joined].end());
    members_[joined] = {};
    remove(kept, joined);
    for (const std::uint32_t other : others_[joined]) {
      const double* between = members_[other].empty() ? nullptr : sums_.find(joined, other);
      if (between == nullptr) continue;
      const double sum = *between;
      remove(joined, other);
      waiting_.push(waiting(kept, other, add(kept, other, turned ? -sum : sum)));
    }
    others_[joined] = {};
  }

  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::vector<std::uint32_t>> others_;  // groups with a sum; some have joined others since, and have none
  std::vector<std::uint32_t> degree_;               // how many of them have one
  PairSums sums_;  // of the weights between two groups; their number never grows, as those of a group that joins another become its sums
  bool turns_;
  std::vector<Contraction> first_;            // the pairs of the edges, the last comes first: most of all, and a heap of them is slow
  std::priority_queue<Contraction> waiting_;  // those that came later
};

}  // namespace

Signs agree_on_signs(std::size_t nodes, std::vector<SignEdge> edges) {
  Signs out{std::vector<std::int8_t>(nodes, 1), std::vector<std::uint32_t>(nodes)};
  Contractor contractor(nodes, std::move(edges), Contractor::Negative::kTurned);
  contractor.run([&](std::uint32_t, std::uint32_t joined, double sum) {
    if (sum >= 0) return;
    for (const std::uint32_t i : contractor.members(joined)) out.sign[i] = static_cast<std::int8_t>(-out.sign[i]);
  });
  for (std::uint32_t g = 0; g < nodes; ++g) {
    const std::vector<std::uint32_t>& group = contractor.members(g);
    const std::uint32_t least = group.empty() ? 0 : *std::min_element(group.begin(), group.end());
    for (const std::uint32_t i : group) out.component[i] = least;
  }
  return out;
}

std::vector<Hold> held_together(std::size_t nodes, std::vector<SignEdge> edges) {
  std::vector<double> degree(nodes, 0);  // of the nodes of a group together
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
  Contractor contractor(nodes, std::move(edges), Contractor::Negative::kKept);
  contractor.run([&](std::uint32_t kept, std::uint32_t joined, double sum) {
    const std::uint32_t smaller = contractor.members(kept).size() < contractor.members(joined).size() ? kept : joined;
    const auto size = static_cast<double>(contractor.members(smaller).size());
    const double node = degree[smaller] / size;
    const double holds = node > 0 ? std::clamp(rim[smaller] / node, 0.0, std::sqrt(size)) : 0;
    const auto chance = static_cast<float>(1 - (1 - holds / std::sqrt(size)) / (holds + 2));
    ++groups;
    for (const std::uint32_t i : contractor.members(smaller)) {
      if (chance < hold[i].chance) hold[i] = {chance, groups};
    }
    degree[kept] += degree[joined];
    rim[kept] += rim[joined] - 2 * sum;
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
