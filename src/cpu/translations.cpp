// Products of translation matrices with expansions. Highway compiles this file once per instruction set.
//
// A tile of expansions is packed side by side, so that all of a tile are at fixed distances from one pointer, and goes through the matrix
// two vectors of rows at a time; sums stay in registers.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/translations.cpp"
#include "cpu/translations.h"

#include "sum/expansions.h"

#include <type_traits>
#include <utility>

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class T>
using Tag = hn::CappedTag<T, kLanes>;
template <class T>
using Vec = hn::Vec<Tag<T>>;

constexpr std::size_t kTile = 9;  // expansions of one tile: 2 x 9 sums and their operands fit 32 registers
constexpr std::size_t kPackedStride = padded_count(coefficient_count(kMaxExpansionOrder));

// One vector of rows: column j, from first to before last, at data + (j - first) * kLanes.
template <class T>
struct Rows {
  const T* data;
  std::size_t first;
  std::size_t last;
};

// Calls use(v) for v = 0 .. kCount - 1, each a constant: arrays stay in registers where their index is one.
template <std::size_t kCount, class Use>
HWY_INLINE void Each(const Use& use) {
  [&]<std::size_t... kIndex>(std::index_sequence<kIndex...>) HWY_ATTR {
    (use(std::integral_constant<std::size_t, kIndex>()), ...);
  }(std::make_index_sequence<kCount>());
}

// sum[c] += columns [first, last) of one vector of rows times expansion c.
template <class T, std::size_t kCount>
HWY_INLINE void MultiplyColumns(const Rows<T>& rows, std::size_t first, std::size_t last, const T* HWY_RESTRICT packed,
                                Vec<T> (&sum)[kCount]) {
  const Tag<T> d;
  for (std::size_t j = first; j < last; ++j) {
    const Vec<T> m = hn::Load(d, rows.data + (j - rows.first) * kLanes);
    for (std::size_t c = 0; c < kCount; ++c) sum[c] = hn::MulAdd(m, hn::Set(d, packed[c * kPackedStride + j]), sum[c]);
  }
}

// sum[v][c] = rows v of the matrix times expansion c.
template <class T, std::size_t kVectors, std::size_t kCount>
HWY_INLINE void MultiplyRows(const Rows<T>* rows, const T* HWY_RESTRICT packed, Vec<T> (&sum)[kVectors][kCount]) {
  const Tag<T> d;
  for (std::size_t v = 0; v < kVectors; ++v) {
    for (std::size_t c = 0; c < kCount; ++c) sum[v][c] = hn::Zero(d);
  }
  const std::size_t first = HWY_MAX(rows[0].first, rows[kVectors - 1].first);
  const std::size_t last = HWY_MAX(first, HWY_MIN(rows[0].last, rows[kVectors - 1].last));
  for (std::size_t j = first; j < last; ++j) {
    Vec<T> m[kVectors];
    for (std::size_t v = 0; v < kVectors; ++v) m[v] = hn::Load(d, rows[v].data + (j - rows[v].first) * kLanes);
    for (std::size_t c = 0; c < kCount; ++c) {
      const Vec<T> value = hn::Set(d, packed[c * kPackedStride + j]);
      for (std::size_t v = 0; v < kVectors; ++v) sum[v][c] = hn::MulAdd(m[v], value, sum[v][c]);
    }
  }
  if constexpr (kVectors > 1) {
    Each<kVectors>([&](auto v) HWY_ATTR {
      MultiplyColumns<T, kCount>(rows[v], rows[v].first, first, packed, sum[v]);
      MultiplyColumns<T, kCount>(rows[v], last, rows[v].last, packed, sum[v]);
    });
  }
}

// Calls use(vectors (as a type), Rows of each, first row) for all rows.
template <class T, class Use>
HWY_INLINE void ForRows(const TranslationMatrix<T>& matrix, const Use& use) {
  const std::size_t lanes = hn::Lanes(Tag<T>());
  Rows<T> rows[2];
  std::size_t waiting = 0;
  const T* group = matrix.data;
  for (std::size_t g = 0; g < matrix.groups; ++g) {
    const ColumnRange& range = matrix.columns[g];
    for (std::size_t lane = 0; lane < kLanes; lane += lanes) {
      rows[waiting++] = {group + lane, range.first, HWY_MIN(range.last, matrix.most_columns)};
      if (waiting < 2) continue;
      use(std::integral_constant<std::size_t, 2>(), rows, g * kLanes + lane - lanes);
      waiting = 0;
    }
    group += (range.last - range.first) * kLanes;
  }
  if (waiting > 0) use(std::integral_constant<std::size_t, 1>(), rows, matrix.groups * kLanes - lanes);
}

// One tile: expansion c goes from from[c] to to[c]; kCount / kMoves of them after one another share signs. `finish` changes the products of
// one vector of rows.
template <class T, std::size_t kCount, std::size_t kMoves, class Finish>
HWY_INLINE void TranslateTile(const TranslationMatrix<T>& matrix, const T* const* from, T* const* to, const T* const* signs,
                              const Finish& finish) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr std::size_t kChannels = kCount / kMoves;
  HWY_ALIGN T packed[kCount * kPackedStride];
  for (std::size_t j = 0; j < matrix.most_columns; j += lanes) {
    for (std::size_t m = 0; m < kMoves; ++m) {
      const Vec<T> sign = hn::Load(d, signs[m] + j);
      for (std::size_t c = m * kChannels; c < (m + 1) * kChannels; ++c) {
        hn::Store(hn::Mul(sign, hn::Load(d, from[c] + j)), d, packed + c * kPackedStride + j);
      }
    }
  }
  ForRows<T>(matrix, [&](auto vectors, const Rows<T>* rows, std::size_t row) HWY_ATTR {
    Vec<T> sum[vectors][kCount];
    MultiplyRows<T, vectors, kCount>(rows, packed, sum);
    Each<vectors>([&](auto v) HWY_ATTR {
      finish(sum[v]);
      const std::size_t at = row + v * lanes;
      Each<kMoves>([&](auto m) HWY_ATTR {
        const Vec<T> sign = hn::Load(d, signs[m] + at);
        Each<kChannels>([&](auto k) HWY_ATTR {
          constexpr std::size_t c = m * kChannels + k;
          hn::Store(hn::MulAdd(sign, sum[v][c], hn::Load(d, to[c] + at)), d, to[c] + at);
        });
      });
    });
  });
}

// Asks for expansions ahead of their use: neither sources nor targets follow the ones before in memory.
template <class T>
HWY_INLINE void Prefetch(const T* from, const T* to, std::size_t columns) {
  constexpr std::size_t kLine = 64 / sizeof(T);
  for (std::size_t j = 0; j < columns; j += kLine) {
    hwy::Prefetch(from + j);
    hwy::Prefetch(to + j);
  }
}

template <class T>
void TranslateAll(const TranslationMatrix<T>& matrix, const Translation<T>* translations, std::size_t count, std::size_t channels,
                  std::size_t distance) {
  constexpr std::size_t kBatch = 8 * kTile;  // expansions; all channels of a translation, whatever their number
  const T* from[kBatch];
  const T* signs[kBatch];
  T* to[kBatch];
  const auto keep = [](Vec<T>* /*sum*/) {};
  for (std::size_t i = 0; i < count;) {
    std::size_t size = 0;
    for (; i < count && size + channels <= kBatch; ++i) {
      for (std::size_t c = 0; c < channels; ++c, ++size) {
        from[size] = translations[i].from + c * distance;
        to[size] = translations[i].to + c * distance;
        signs[size] = translations[i].signs;
      }
    }
    std::size_t c = 0;
    for (; c + kTile <= size; c += kTile) {
      for (std::size_t next = c + kTile; next < HWY_MIN(c + 2 * kTile, size); ++next) Prefetch(from[next], to[next], matrix.most_columns);
      TranslateTile<T, kTile, kTile>(matrix, from + c, to + c, signs + c, keep);
    }
    for (; c + 4 <= size; c += 4) TranslateTile<T, 4, 4>(matrix, from + c, to + c, signs + c, keep);
    for (; c + 2 <= size; c += 2) TranslateTile<T, 2, 2>(matrix, from + c, to + c, signs + c, keep);
    for (; c < size; ++c) TranslateTile<T, 1, 1>(matrix, from + c, to + c, signs + c, keep);
  }
}

// The matrix does not mix expansions, so moments are moved after it, where that is a few operations per vector.
template <class T, std::size_t kChannels>
void TranslateStokes(const TranslationMatrix<T>& matrix, const Translation<T>* translations, std::size_t count, std::size_t distance) {
  const Tag<T> d;
  const T* from[kChannels];
  T* to[kChannels];
  for (std::size_t i = 0; i < count; ++i) {
    const Translation<T>& t = translations[i];
    for (std::size_t c = 0; c < kChannels; ++c) {
      from[c] = t.from + c * distance;
      to[c] = t.to + c * distance;
    }
    TranslateTile<T, kChannels, 1>(matrix, from, to, &t.signs, [&](Vec<T>* sum) HWY_ATTR {
      for (std::size_t a = 0; a < 3; ++a) {
        const Vec<T> shift = hn::Set(d, t.move[a]);
        sum[1 + a] = hn::MulAdd(shift, sum[0], sum[1 + a]);
        sum[7] = hn::MulAdd(shift, sum[4 + a], sum[7]);
      }
    });
  }
}

// M2L of one form of S: the expansions taken from a source, and where they go at the target.
template <bool kTransposed, bool kWeighted>
struct StokesRoute {
  static constexpr std::size_t kCount = (kTransposed ? 5 : 4) + (kWeighted ? 1 : 0);
  static constexpr std::size_t from(std::size_t c) {
    if (c == 0) return 0;
    return kWeighted && c == kCount - 1 ? kStokesMultipoles : c + (kTransposed ? 3 : 0);
  }
  static constexpr std::size_t to(std::size_t c) {
    if (c == 0) return kTransposed ? kTransposedWinding : 0;
    return kWeighted && c == kCount - 1 ? kStokesLocals : from(c);
  }
};

template <class T, std::size_t kPairs, bool kTransposed, bool kWeighted>
HWY_INLINE void StokesPairsTile(const TranslationMatrix<T>& matrix, const Translation<T>* pairs, std::size_t distance) {
  using Route = StokesRoute<kTransposed, kWeighted>;
  constexpr std::size_t kCount = Route::kCount;
  const Tag<T> d;
  const T* from[kPairs * kCount];
  const T* signs[kPairs];
  T* to[kPairs * kCount];
  for (std::size_t p = 0; p < kPairs; ++p) {
    signs[p] = pairs[p].signs;
    for (std::size_t c = 0; c < kCount; ++c) {
      from[p * kCount + c] = pairs[p].from + Route::from(c) * distance;
      to[p * kCount + c] = pairs[p].to + Route::to(c) * distance;
    }
  }
  TranslateTile<T, kPairs * kCount, kPairs>(matrix, from, to, signs, [&](Vec<T>* sum) HWY_ATTR {
    for (std::size_t p = 0; p < kPairs; ++p) {
      Vec<T>* one = sum + p * kCount;  // W, E_a; or W, P_a, Q
      for (std::size_t a = 0; a < 3; ++a) {
        Vec<T>& moment = one[kTransposed ? 4 : 1 + a];
        moment = hn::MulAdd(hn::Set(d, pairs[p].move[a]), one[kTransposed ? 1 + a : 0], moment);
      }
    }
  });
}

template <class T, bool kTransposed, bool kWeighted>
void TranslateStokesPairs(const TranslationMatrix<T>& matrix, const Translation<T>* pairs, std::size_t count, std::size_t distance) {
  using Route = StokesRoute<kTransposed, kWeighted>;
  std::size_t i = 0;
  for (; i + 2 <= count; i += 2) {
    for (std::size_t next = i + 2; next < HWY_MIN(i + 4, count); ++next) {
      for (std::size_t c = 0; c < Route::kCount; ++c) {
        Prefetch(pairs[next].from + Route::from(c) * distance, pairs[next].to + Route::to(c) * distance, matrix.most_columns);
      }
    }
    StokesPairsTile<T, 2, kTransposed, kWeighted>(matrix, pairs + i, distance);
  }
  if (i < count) StokesPairsTile<T, 1, kTransposed, kWeighted>(matrix, pairs + i, distance);
}

template <class T, bool kTransposed>
void TranslateStokesPairs(const TranslationMatrix<T>& matrix, const Translation<T>* pairs, std::size_t count, std::size_t channels,
                          std::size_t distance) {
  if (channels == kStokesMultipoles) return TranslateStokesPairs<T, kTransposed, false>(matrix, pairs, count, distance);
  TranslateStokesPairs<T, kTransposed, true>(matrix, pairs, count, distance);
}

template <class T>
void Translate(const TranslationMatrix<T>& matrix, const Translation<T>* translations, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved) {
  switch (moved) {
    case Moved::kStokes:
      static_assert(kStokesLocals == kStokesMultipoles + 1);
      if (channels == kStokesMultipoles) return TranslateStokes<T, kStokesMultipoles>(matrix, translations, count, distance);
      if (channels == kStokesLocals) return TranslateStokes<T, kStokesLocals>(matrix, translations, count, distance);
      return TranslateStokes<T, kStokesLocals + 1>(matrix, translations, count, distance);
    case Moved::kStokesForward:
      return TranslateStokesPairs<T, false>(matrix, translations, count, channels, distance);
    case Moved::kStokesTransposed:
      return TranslateStokesPairs<T, true>(matrix, translations, count, channels, distance);
    case Moved::kAll:
      return TranslateAll(matrix, translations, count, channels, distance);
  }
}

void TranslateFloat(const TranslationMatrix<float>& matrix, const Translation<float>* translations, std::size_t count, std::size_t channels,
                    std::size_t distance, Moved moved) {
  Translate(matrix, translations, count, channels, distance, moved);
}
void TranslateDouble(const TranslationMatrix<double>& matrix, const Translation<double>* translations, std::size_t count,
                     std::size_t channels, std::size_t distance, Moved moved) {
  Translate(matrix, translations, count, channels, distance, moved);
}

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace g3r::cpu {

HWY_EXPORT(TranslateFloat);
HWY_EXPORT(TranslateDouble);

void translate(const TranslationMatrix<float>& matrix, const Translation<float>* translations, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved) {
  HWY_DYNAMIC_DISPATCH(TranslateFloat)(matrix, translations, count, channels, distance, moved);
}
void translate(const TranslationMatrix<double>& matrix, const Translation<double>* translations, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved) {
  HWY_DYNAMIC_DISPATCH(TranslateDouble)(matrix, translations, count, channels, distance, moved);
}

}  // namespace g3r::cpu
#endif
