// The matrices of M2L: which terms they have, and which offsets share one. docs/math.md, "Expansions".
#pragma once

#include "cpu/aligned_vector.h"
#include "cpu/translations.h"
#include "expansions/expansions.h"
#include "tree/interaction_lists.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Which terms of an M2L matrix count.
struct M2lTerms {
  int order = 4;         ///< of the expansions
  double opening = 0.5;  ///< of the far pairs, see SumPlan
  double cut = 8;        ///< see kept_degrees()
};

/// For every degree j <= order of the target, the highest degree n <= order of the source that counts; -1 for none; not increasing. The
/// term of degrees j and n is C(j + n, j) a^j b^n in size, a and b the mean radii of target and source over their distance. It counts, and
/// with it all of lower degrees, from cut times (q/2)^(order + 1) on, q = a + b at the opening: the first term that the order leaves out
/// there. Degrees up to 1 always count. Opposite offsets keep transposed terms, so adjoints stay exact.
[[nodiscard]] std::vector<int> kept_degrees(const Offset& offset, const M2lTerms& terms);

/// A row-major n x n matrix, triangular by degrees (M2M: zero where the column's is higher; L2L: its transpose, scaled), in the layout of
/// cpu::TranslationMatrix.
template <class T>
class StoredTranslation {
 public:
  StoredTranslation() = default;
  StoredTranslation(const std::vector<double>& matrix, std::size_t n, bool transposed, double scale);
  /// Of the first `coefficients`.
  [[nodiscard]] cpu::TranslationMatrix<T> first(std::size_t coefficients) const;

 private:
  std::vector<cpu::ColumnRange> columns_;
  AlignedVector<T> data_;
};

/// M2L matrices of a geometry. Mirror images of an offset differ by the signs of coefficients and share one matrix:
///   K(s d) = D_s K(d) D_s,  s = (+-1, +-1, +-1),  D_s = diag(+-1).
template <class T>
class M2lMatrices {
 public:
  M2lMatrices() = default;
  /// `offsets` as in InteractionLists: mirror images side by side.
  M2lMatrices(const std::vector<Offset>& offsets, const M2lTerms& terms);

  /// Number of the matrix that an offset uses; not decreasing.
  [[nodiscard]] std::size_t index(std::size_t offset) const { return index_[offset]; }
  /// D_s of an offset.
  [[nodiscard]] const T* signs(const Offset& offset) const { return signs_.data() + offset.mirror() * signs_.size() / kMirrors; }
  /// The layout of a matrix, without its data.
  [[nodiscard]] cpu::TranslationMatrix<T> shape(std::size_t index) const;
  /// `made` holds the matrix where all are too large to be kept.
  [[nodiscard]] cpu::TranslationMatrix<T> matrix(std::size_t index, AlignedVector<T>& made) const;

 private:
  static constexpr std::size_t kMirrors = 8;

  void store(std::size_t index, T* out) const;

  M2lTerms terms_;
  MultipoleToLocal make_{0};
  std::vector<std::uint32_t> index_;       // of every offset
  std::vector<Offset> offsets_;            // of every matrix, without its signs
  std::vector<std::size_t> groups_begin_;  // of every matrix in columns_
  std::vector<cpu::ColumnRange> columns_;  // of every group of rows
  std::vector<std::size_t> matrix_begin_;  // of every matrix in matrices_
  AlignedVector<T> matrices_;              // empty when too large to keep
  AlignedVector<T> signs_;                 // of every mirror image
};

extern template class StoredTranslation<float>;
extern template class StoredTranslation<double>;
extern template class M2lMatrices<float>;
extern template class M2lMatrices<double>;

}  // namespace g3r
