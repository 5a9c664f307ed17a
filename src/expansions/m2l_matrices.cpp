#include "expansions/m2l_matrices.h"

#include "cpu/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace g3r {
namespace {

constexpr std::size_t kBlock = 32;                    // matrices per parallel block
constexpr std::size_t kKeptMatrixBytes = 128u << 20;  // M2L matrices kept in memory up to this; beyond, made when needed
// Mean distance of a patch's points from the centre of its cube, in half sides; and of the farthest, on which the opening is based.
constexpr double kMeanRadius = 0.8;
constexpr double kFarthestRadius = 1.3;

std::vector<int> degrees(std::size_t coefficients) {
  std::vector<int> out;
  for (int l = 0; out.size() < coefficients; ++l) out.insert(out.end(), 2 * static_cast<std::size_t>(l) + 1, l);
  return out;
}

// Columns of every group of rows: those that the lowest of its degrees keeps.
std::vector<cpu::ColumnRange> columns_of(const std::vector<int>& kept) {
  std::vector<cpu::ColumnRange> columns;
  const std::size_t n = coefficient_count(static_cast<int>(kept.size()) - 1);
  const std::vector<int> degree = degrees(n);
  for (std::size_t row = 0; row < n; row += cpu::kLanes) {
    const int highest = kept[static_cast<std::size_t>(degree[row])];
    if (highest < 0) break;
    columns.push_back({0, static_cast<std::uint32_t>(coefficient_count(highest))});
  }
  return columns;
}

double binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

// +-1 for every coefficient: how B changes when the axes of `mirror` (bit 0: x) turn round.
double sign(unsigned mirror, int l, int m, bool imaginary) {
  int odd = 0;
  if (mirror & 1U) odd += imaginary ? m + 1 : m;
  if (mirror & 2U) odd += imaginary ? 1 : 0;
  if (mirror & 4U) odd += l + m;
  return odd % 2 == 0 ? 1 : -1;
}

}  // namespace

std::vector<int> kept_degrees(const Offset& offset, const M2lTerms& terms) {
  const double distance = std::hypot(offset.displacement[0], offset.displacement[1], offset.displacement[2]);
  const double a = kMeanRadius * std::ldexp(1.0, std::max(offset.level_difference, 0)) / distance;
  const double b = kMeanRadius * std::ldexp(1.0, std::max(-offset.level_difference, 0)) / distance;
  const double nearest = kMeanRadius / kFarthestRadius * terms.opening;
  const double least = terms.cut * std::pow(nearest / 2, terms.order + 1);
  std::vector<int> kept(static_cast<std::size_t>(terms.order) + 1, -1);
  for (int j = terms.order; j >= 0; --j) {
    int& highest = kept[static_cast<std::size_t>(j)];
    highest = j < terms.order ? kept[static_cast<std::size_t>(j) + 1] : -1;
    for (int n = highest + 1; n <= terms.order; ++n) {
      const double term = std::pow(a, j) * std::pow(b, n) * binomial(j + n, std::min(j, n));  // in this order, exactly symmetric
      if (term >= least || (j <= 1 && n <= 1)) highest = n;
    }
  }
  return kept;
}

template <class T>
StoredTranslation<T>::StoredTranslation(const std::vector<double>& matrix, std::size_t n, bool transposed, double scale) {
  const std::vector<int> degree = degrees(n);
  for (std::size_t group = 0; group < n; group += cpu::kLanes) {
    const std::size_t end = std::min(group + cpu::kLanes, n);
    const std::size_t first = transposed ? coefficient_count(degree[group] - 1) : 0;
    const std::size_t last = transposed ? n : coefficient_count(degree[end - 1]);
    columns_.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)});
    for (std::size_t j = first; j < last; ++j) {
      for (std::size_t i = group; i < group + cpu::kLanes; ++i) {
        data_.push_back(i < n ? static_cast<T>(scale * (transposed ? matrix[j * n + i] : matrix[i * n + j])) : T{0});
      }
    }
  }
}

template <class T>
cpu::TranslationMatrix<T> StoredTranslation<T>::first(std::size_t coefficients) const {
  return {data_.data(), columns_.data(), cpu::padded_count(coefficients) / cpu::kLanes, static_cast<std::uint32_t>(coefficients)};
}

template <class T>
M2lMatrices<T>::M2lMatrices(const std::vector<Offset>& offsets, const M2lTerms& terms)
    : terms_(terms), make_(terms.order), groups_begin_(1, 0), matrix_begin_(1, 0) {
  const std::size_t n = coefficient_count(terms.order);
  const std::size_t stride = cpu::padded_count(n);
  signs_.assign(kMirrors * stride, T{0});
  for (unsigned mirror = 0; mirror < kMirrors; ++mirror) {
    T* out = signs_.data() + mirror * stride;
    for (int l = 0; l <= terms.order; ++l) {
      for (int m = 0; m <= l; ++m) {
        out[real_index(l, m)] = static_cast<T>(sign(mirror, l, m, false));
        if (m > 0) out[imaginary_index(l, m)] = static_cast<T>(sign(mirror, l, m, true));
      }
    }
  }
  for (const Offset& offset : offsets) {
    const Offset unsigned_offset{offset.level_difference, offset.magnitude()};
    if (offsets_.empty() || offsets_.back() != unsigned_offset) offsets_.push_back(unsigned_offset);
    index_.push_back(static_cast<std::uint32_t>(offsets_.size() - 1));
  }
  for (const Offset& offset : offsets_) {
    const std::vector<cpu::ColumnRange> columns = columns_of(kept_degrees(offset, terms));
    std::size_t size = 0;
    for (const cpu::ColumnRange& range : columns) size += range.last * cpu::kLanes;
    columns_.insert(columns_.end(), columns.begin(), columns.end());
    groups_begin_.push_back(columns_.size());
    matrix_begin_.push_back(matrix_begin_.back() + size);
  }
  if (matrix_begin_.back() * sizeof(T) > kKeptMatrixBytes) return;
  matrices_.resize(matrix_begin_.back());
  parallel::for_blocks(offsets_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) store(i, matrices_.data() + matrix_begin_[i]);
  });
}

template <class T>
void M2lMatrices<T>::store(std::size_t index, T* out) const {
  const std::vector<int> kept = kept_degrees(offsets_[index], terms_);
  const std::size_t n = coefficient_count(terms_.order);
  const std::vector<int> degree = degrees(n);
  const std::vector<double> matrix = make_.matrix(offsets_[index]);
  for (std::size_t g = groups_begin_[index]; g < groups_begin_[index + 1]; ++g) {
    for (std::size_t j = 0; j < columns_[g].last; ++j, out += cpu::kLanes) {
      for (std::size_t lane = 0; lane < cpu::kLanes; ++lane) {
        const std::size_t row = (g - groups_begin_[index]) * cpu::kLanes + lane;
        const bool counts = row < n && degree[j] <= kept[static_cast<std::size_t>(degree[row])];
        out[lane] = counts ? static_cast<T>(matrix[row * n + j]) : T{0};
      }
    }
  }
}

template <class T>
cpu::TranslationMatrix<T> M2lMatrices<T>::shape(std::size_t index) const {
  const std::size_t first = groups_begin_[index];
  return {nullptr, columns_.data() + first, groups_begin_[index + 1] - first, columns_[first].last};
}

template <class T>
cpu::TranslationMatrix<T> M2lMatrices<T>::matrix(std::size_t index, AlignedVector<T>& made) const {
  const T* data = matrices_.data() + (matrices_.empty() ? 0 : matrix_begin_[index]);
  if (matrices_.empty()) {
    made.resize(matrix_begin_[index + 1] - matrix_begin_[index]);
    store(index, made.data());
    data = made.data();
  }
  cpu::TranslationMatrix<T> out = shape(index);
  out.data = data;
  return out;
}

template class StoredTranslation<float>;
template class StoredTranslation<double>;
template class M2lMatrices<float>;
template class M2lMatrices<double>;

}  // namespace g3r
