#include "expansions/expansions.h"

#include <cmath>
#include <complex>
#include <cstdlib>
#include <utility>

namespace g3r {
namespace {

using Complex = std::complex<double>;

double parity(int m) { return m % 2 == 0 ? 1.0 : -1.0; }

// R_l^m of any sign of m from the real basis; zero outside |m| <= l.
Complex regular(const std::vector<double>& b, int l, int m) {
  const int k = std::abs(m);
  if (l < 0 || k > l) return 0;
  const Complex value(b[real_index(l, k)], k > 0 ? b[imaginary_index(l, k)] : 0.0);
  return m >= 0 ? value : parity(k) * std::conj(value);
}

// All harmonics to an order, column by column of one m: H_0^0 = `first`, H_m^m = H_{m-1}^{m-1} along(m), and
// H_l^m = up(l, m, H_{l-1}^m, H_{l-2}^m) above it.
template <class Along, class Up>
std::vector<double> by_columns(int order, Complex first, const Along& along, const Up& up) {
  std::vector<double> out(coefficient_count(order));
  Complex diagonal = first;
  for (int m = 0; m <= order; ++m) {
    if (m > 0) diagonal *= along(m);
    Complex value = diagonal, below = 0, second_below = 0;
    for (int l = m; l <= order; ++l) {
      if (l > m) {
        second_below = std::exchange(below, value);
        value = up(l, m, below, second_below);
      }
      out[real_index(l, m)] = value.real();
      if (m > 0) out[imaginary_index(l, m)] = value.imag();
    }
  }
  return out;
}

}  // namespace

std::vector<double> regular_harmonics(const Vec3& b, int order) {
  const double r2 = b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
  return by_columns(
      order, 1, [&](int m) { return -Complex(b[0], b[1]) / (2.0 * m); },
      [&](int l, int m, const Complex& below, const Complex& second_below) {
        return ((2.0 * l - 1) * b[2] * below - r2 * second_below) / static_cast<double>((l + m) * (l - m));
      });
}

std::vector<double> irregular_harmonics(const Vec3& d, int order) {
  const double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  return by_columns(
      order, 1 / std::sqrt(r2), [&](int m) { return -(2.0 * m - 1) * Complex(d[0], d[1]) / r2; },
      [&](int l, int m, const Complex& below, const Complex& second_below) {
        return ((2.0 * l - 1) * d[2] * below - static_cast<double>((l - 1) * (l - 1) - m * m) * second_below) / r2;
      });
}

// R_l^m(t + b) = sum_{j,k} R_{l-j}^{m-k}(t) R_j^k(b); b is the child's coordinate times 1/2, hence 2^-j.
std::vector<double> multipole_translation(const Vec3& shift, int order) {
  const std::size_t n = coefficient_count(order);
  const std::vector<double> t = regular_harmonics(shift, order);
  std::vector<double> matrix(n * n, 0.0);
  for (int l = 0; l <= order; ++l) {
    for (int m = 0; m <= l; ++m) {
      for (int j = 0; j <= l; ++j) {
        const double scale = std::ldexp(1.0, -j);
        for (int k = 0; k <= j; ++k) {
          const Complex plus = regular(t, l - j, m - k);
          const Complex minus = k > 0 ? parity(k) * regular(t, l - j, m + k) : Complex(0);
          const Complex on_real = scale * (plus + minus);
          const Complex on_imaginary = scale * Complex(0, 1) * (plus - minus);
          matrix[real_index(l, m) * n + real_index(j, k)] = on_real.real();
          if (k > 0) matrix[real_index(l, m) * n + imaginary_index(j, k)] = on_imaginary.real();
          if (m > 0) matrix[imaginary_index(l, m) * n + real_index(j, k)] = on_real.imag();
          if (m > 0 && k > 0) matrix[imaginary_index(l, m) * n + imaginary_index(j, k)] = on_imaginary.imag();
        }
      }
    }
  }
  return matrix;
}

// 1/|d + a - b| = sum (-1)^j conj(R_j^k(a)) conj(R_n^q(b)) S_{j+n}^{k+q}(d), the signs of k and q folded into products of real parts:
// with S_{j+n}^{k+q} = P + iQ and S_{j+n}^{k-q} = p + iq', the entries are 2(P + (-1)^q p) for Re Re, 2(-P + (-1)^q p) for Im Im,
// 2(Q - (-1)^q q') for Re Im, 2(Q + (-1)^q q') for Im Re; half of that for each of k, q that is 0.
MultipoleToLocal::MultipoleToLocal(int order) : order_(order), entries_(coefficient_count(order) * coefficient_count(order)) {
  const std::size_t n = coefficient_count(order);
  for (int j = 0; j <= order; ++j) {
    for (int k = 0; k <= j; ++k) {
      for (int s = 0; s <= order; ++s) {
        for (int q = 0; q <= s; ++q) {
          const int l = j + s;
          const int sum = k + q;
          const int difference = std::abs(k - q);
          // S_l^{k-q}: for k < q it is (-1)^{q-k} conj(S_l^{q-k})
          const double swap = k < q ? parity(q - k) : 1.0;
          const double swap_imaginary = k < q ? -swap : 1.0;
          const double factor = 2 * parity(j) * (k == 0 ? 0.5 : 1.0) * (q == 0 ? 0.5 : 1.0);
          const double sign = parity(q);
          const auto at = [&](std::size_t row, std::size_t column) -> Entry& { return entries_[row * n + column]; };
          const auto re = [l](int m) { return static_cast<std::uint32_t>(real_index(l, m)); };
          const auto im = [l](int m) { return static_cast<std::uint32_t>(m > 0 ? imaginary_index(l, m) : real_index(l, 0)); };
          const double imaginary_sum = sum > 0 ? factor : 0.0;
          const double imaginary_difference = difference > 0 ? factor * sign * swap_imaginary : 0.0;
          at(real_index(j, k), real_index(s, q)) = {re(sum), re(difference), factor, factor * sign * swap};
          if (k > 0 && q > 0) {
            at(imaginary_index(j, k), imaginary_index(s, q)) = {re(sum), re(difference), -factor, factor * sign * swap};
          }
          if (q > 0) at(real_index(j, k), imaginary_index(s, q)) = {im(sum), im(difference), imaginary_sum, -imaginary_difference};
          if (k > 0) at(imaginary_index(j, k), real_index(s, q)) = {im(sum), im(difference), imaginary_sum, imaginary_difference};
        }
      }
    }
  }
}

std::vector<double> MultipoleToLocal::matrix(const Offset& offset) const {
  const std::size_t n = coefficient_count(order_);
  const Vec3 d{static_cast<double>(offset.displacement[0]), static_cast<double>(offset.displacement[1]),
               static_cast<double>(offset.displacement[2])};
  const std::vector<double> irregular = irregular_harmonics(d, 2 * order_);
  const double target = std::ldexp(1.0, std::max(offset.level_difference, 0));  // half sides in units of the smaller one
  const double source = std::ldexp(1.0, std::max(-offset.level_difference, 0));
  std::vector<double> out(n * n);
  double row_scale = target;
  for (int j = 0; j <= order_; ++j, row_scale *= target) {
    for (std::size_t row = real_index(j, 0); row < real_index(j + 1, 0); ++row) {
      double scale = row_scale;
      for (int s = 0; s <= order_; ++s, scale *= source) {
        for (std::size_t column = real_index(s, 0); column < real_index(s + 1, 0); ++column) {
          const Entry& e = entries_[row * n + column];
          out[row * n + column] = scale * (e.first_factor * irregular[e.first] + e.second_factor * irregular[e.second]);
        }
      }
    }
  }
  return out;
}

}  // namespace g3r
