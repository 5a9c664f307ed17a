#include "orient/sign_graph.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace g3r {
namespace {

// A pair of groups waiting to become one. Of equal sums the one with the smaller groups comes first.
struct Contraction {
  double sum;
  std::uint32_t a, b;  // a < b
  bool operator<(const Contraction& other) const {
    return std::make_tuple(std::abs(sum), other.a, other.b) < std::make_tuple(std::abs(other.sum), a, b);
  }
};

class Contractor {
 public:
  Contractor(std::size_t nodes, const std::vector<SignEdge>& edges) : members_(nodes), sums_(nodes), sign_(nodes, 1) {
    for (std::uint32_t i = 0; i < nodes; ++i) members_[i] = {i};
    for (const SignEdge& edge : edges) {
      if (edge.a == edge.b) continue;
      sums_[edge.a][edge.b] += edge.weight;
      sums_[edge.b][edge.a] += edge.weight;
    }
    std::vector<Contraction> first;
    for (std::uint32_t a = 0; a < nodes; ++a) {
      for (const auto& [b, sum] : sums_[a]) {
        if (a < b) first.push_back({sum, a, b});
      }
    }
    waiting_ = std::priority_queue<Contraction>(std::less<Contraction>(), std::move(first));
  }

  Signs run() {
    while (!waiting_.empty()) {
      const Contraction next = waiting_.top();
      waiting_.pop();
      const auto found = sums_[next.a].find(next.b);
      if (found != sums_[next.a].end() && found->second == next.sum) contract(next);  // else the sum has changed since
    }
    Signs out{std::move(sign_), std::vector<std::uint32_t>(members_.size())};
    for (const std::vector<std::uint32_t>& group : members_) {
      const std::uint32_t least = group.empty() ? 0 : *std::min_element(group.begin(), group.end());
      for (const std::uint32_t i : group) out.component[i] = least;
    }
    return out;
  }

 private:
  // The group with fewer neighbours joins the other.
  void contract(const Contraction& pair) {
    std::uint32_t kept = pair.a;
    std::uint32_t joined = pair.b;
    if (sums_[kept].size() < sums_[joined].size()) std::swap(kept, joined);
    const bool turned = pair.sum < 0;
    sums_[kept].erase(joined);
    for (const std::uint32_t i : members_[joined]) {
      if (turned) sign_[i] = static_cast<std::int8_t>(-sign_[i]);
      members_[kept].push_back(i);
    }
    members_[joined] = {};
    for (const auto& [other, sum] : sums_[joined]) {
      if (other == kept) continue;
      sums_[other].erase(joined);
      const double together = sums_[kept][other] += turned ? -sum : sum;
      sums_[other][kept] = together;
      waiting_.push({together, std::min(kept, other), std::max(kept, other)});
    }
    sums_[joined].clear();
  }

  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::unordered_map<std::uint32_t, double>> sums_;  // of the weights between two groups; of groups that have joined: none
  std::vector<std::int8_t> sign_;
  std::priority_queue<Contraction> waiting_;
};

}  // namespace

Signs agree_on_signs(std::size_t nodes, const std::vector<SignEdge>& edges) { return Contractor(nodes, edges).run(); }

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
