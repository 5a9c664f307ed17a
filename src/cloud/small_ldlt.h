// Source: Golub and Van Loan, Matrix Computations, section 4.4: L D L^T with pivots on the diagonal.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace g3r {

/// P A P^T = L D L^T of a symmetric N x N matrix, of which the lower triangle is read, the largest of the diagonal first; and x of A x = b.
/// The same steps, and the same bytes, as Eigen's LDLT with instructions for two doubles, which takes three seconds to compile for each N.
template <int N>
class SmallLdlt {
  using Square = Eigen::Matrix<double, N, N>;
  using Numbers = Eigen::Vector<double, N>;

 public:
  explicit SmallLdlt(const Square& a) : m_(a) {
    for (int k = 0; k < N; ++k) {
      bring_largest_to(k);
      std::array<double, N> scaled{};  // D L_k^T
      for (int j = 0; j < k; ++j) scaled[static_cast<std::size_t>(j)] = m_(j, j) * m_(k, j);
      for (int i = k; i < N && k > 0; ++i) {
        double sum = m_(i, 0) * scaled[0];
        for (int j = 1; j < k; ++j) sum += m_(i, j) * scaled[static_cast<std::size_t>(j)];
        m_(i, k) -= sum;
      }
      for (int i = k + 1; i < N && m_(k, k) != 0; ++i) m_(i, k) /= m_(k, k);
    }
  }

  [[nodiscard]] Numbers solve(Numbers x) const {
    for (int k = 0; k < N; ++k) std::swap(x[k], x[from_[static_cast<std::size_t>(k)]]);
    solve_lower<1>(x);
    for (int k = 0; k < N; ++k) x[k] = std::abs(m_(k, k)) > std::numeric_limits<double>::min() ? x[k] / m_(k, k) : 0;
    solve_upper<N - 2>(x);
    for (int k = N - 1; k >= 0; --k) std::swap(x[k], x[from_[static_cast<std::size_t>(k)]]);
    return x;
  }

 private:
  void bring_largest_to(int k) {
    int largest = k;
    for (int i = k + 1; i < N; ++i) {
      if (std::abs(m_(i, i)) > std::abs(m_(largest, largest))) largest = i;
    }
    from_[static_cast<std::size_t>(k)] = largest;
    if (largest == k) return;
    for (int j = 0; j < k; ++j) std::swap(m_(k, j), m_(largest, j));
    for (int i = largest + 1; i < N; ++i) std::swap(m_(i, k), m_(i, largest));
    std::swap(m_(k, k), m_(largest, largest));
    for (int i = k + 1; i < largest; ++i) std::swap(m_(i, k), m_(largest, i));
  }

  // Of terms Begin, Begin + Step, ...: that of the first half and that of the second.
  template <int Begin, int Count, int Step = 1, class Term>
  static double sum(const Term& term) {
    if constexpr (Count == 1) {
      return term(Begin);
    } else {
      return sum<Begin, Count / 2, Step>(term) + sum<Begin + Count / 2 * Step, Count - Count / 2, Step>(term);
    }
  }

  template <int I>
  void solve_lower(Numbers& x) const {
    if constexpr (I < N) {
      x[I] -= sum<0, I>([&](int j) { return m_(I, j) * x[j]; });
      solve_lower<I + 1>(x);
    }
  }

  // Sums of every other term, as of two in one register.
  template <int I>
  void solve_upper(Numbers& x) const {
    if constexpr (I >= 0) {
      constexpr int kPairs = (N - 1 - I) / 2;
      const auto term = [&](int j) { return m_(j, I) * x[j]; };
      if constexpr (kPairs == 0) {
        x[I] -= term(N - 1);
      } else {
        double both = sum<I + 1, kPairs, 2>(term) + sum<I + 2, kPairs, 2>(term);
        if constexpr ((N - 1 - I) % 2 == 1) both += term(N - 1);
        x[I] -= both;
      }
      solve_upper<I - 1>(x);
    }
  }

  Square m_;                            // D on the diagonal, L below it
  std::array<Eigen::Index, N> from_{};  // of each step: which row came to its place
};

}  // namespace g3r
