// Products of translation matrices with expansions. Highway compiles this file once per instruction set.
//
// A tile of expansions is packed side by side, so that all of a tile are at fixed distances from one pointer, and goes through the matrix
// one vector of rows at a time; sums stay in registers.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/translations.cpp"
#include "cpu/translations.h"

#include "kernels/expansion_index.h"

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "cpu/lanes.h"  // NOLINT(llvm-include-order): anew for every instruction set

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {

// Expansions of one tile: their sums and two operands are to fit the registers.
#if HWY_ARCH_X86 && HWY_TARGET > HWY_AVX3
constexpr std::size_t kTile = 12;
#else
constexpr std::size_t kTile = 20;
#endif
constexpr std::size_t kPackedStride = padded_count(coefficient_count(kMaxExpansionOrder));

// Where a node's expansions are: of the source, and where they go at the target.
template <std::size_t kChannels>
struct Route {
  std::size_t from[kChannels];
  std::size_t to[kChannels];
};

// Each to its own place; `distance`: from one to the next.
template <std::size_t kChannels>
Route<kChannels> InPlace(std::size_t distance) {
  Route<kChannels> route;
  for (std::size_t k = 0; k < kChannels; ++k) route.from[k] = route.to[k] = k * distance;
  return route;
}

// One tile: kChannels expansions of each of kMoves translations. `finish` changes the products of one translation and vector of rows.
template <class T, std::size_t kMoves, std::size_t kChannels, class Finish>
HWY_INLINE void TranslateTile(const TranslationMatrix<T>& matrix, const Translation<T>* moves, const Route<kChannels>& route,
                              const Finish& finish) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr std::size_t kCount = kMoves * kChannels;
  HWY_ALIGN T packed[kCount * kPackedStride];
  for (std::size_t j = 0; j < matrix.most_columns; j += lanes) {
    HWY_UNROLL(kTile)
    for (std::size_t m = 0; m < kMoves; ++m) {
      const Vec<T> sign = hn::Load(d, moves[m].signs + j);
      HWY_UNROLL(kTile)
      for (std::size_t k = 0; k < kChannels; ++k) {
        hn::Store(hn::Mul(sign, hn::Load(d, moves[m].from + route.from[k] + j)), d, packed + (m * kChannels + k) * kPackedStride + j);
      }
    }
  }
  const T* rows = matrix.data;
  for (std::size_t g = 0; g < matrix.groups; ++g) {
    const ColumnRange range{matrix.columns[g].first, HWY_MIN(matrix.columns[g].last, matrix.most_columns)};
    for (std::size_t lane = 0; lane < kLanes; lane += lanes) {
      Vec<T> sum[kCount];
      HWY_UNROLL(kTile)
      for (std::size_t c = 0; c < kCount; ++c) sum[c] = hn::Zero(d);
      const T* column = rows + lane;
      for (std::size_t j = range.first; j < range.last; ++j, column += kLanes) {
        const Vec<T> entries = hn::Load(d, column);
        HWY_UNROLL(kTile)
        for (std::size_t c = 0; c < kCount; ++c) sum[c] = hn::MulAdd(entries, hn::Set(d, packed[c * kPackedStride + j]), sum[c]);
      }
      const std::size_t row = g * kLanes + lane;
      HWY_UNROLL(kTile)
      for (std::size_t m = 0; m < kMoves; ++m) {
        finish(moves[m], sum + m * kChannels);
        const Vec<T> sign = hn::Load(d, moves[m].signs + row);
        HWY_UNROLL(kTile)
        for (std::size_t k = 0; k < kChannels; ++k) {
          T* to = moves[m].to + route.to[k] + row;
          hn::Store(hn::MulAdd(sign, sum[m * kChannels + k], hn::Load(d, to)), d, to);
        }
      }
    }
    rows += (matrix.columns[g].last - matrix.columns[g].first) * kLanes;
  }
}

// Asks for the expansions of a translation ahead of their use: neither sources nor targets follow the ones before in memory.
template <class T, std::size_t kChannels>
HWY_INLINE void Prefetch(const Translation<T>& move, const Route<kChannels>& route, std::size_t columns) {
  constexpr std::size_t kLine = 64 / sizeof(T);
  for (std::size_t j = 0; j < columns; j += kLine) {
    for (std::size_t k = 0; k < kChannels; ++k) {
      hwy::Prefetch(move.from + route.from[k] + j);
      hwy::Prefetch(move.to + route.to[k] + j);
    }
  }
}

// Tiles of kMoves translations, and of half as many for those that are left.
template <class T, std::size_t kMoves, std::size_t kChannels, class Finish>
HWY_INLINE void TranslateTiles(const TranslationMatrix<T>& matrix, const Translation<T>* moves, std::size_t count,
                               const Route<kChannels>& route, const Finish& finish) {
  std::size_t i = 0;
  for (; i + kMoves <= count; i += kMoves) {
    for (std::size_t next = i + kMoves; next < HWY_MIN(i + 2 * kMoves, count); ++next) Prefetch(moves[next], route, matrix.most_columns);
    TranslateTile<T, kMoves, kChannels>(matrix, moves + i, route, finish);
  }
  if constexpr (kMoves > 1) TranslateTiles<T, kMoves / 2, kChannels>(matrix, moves + i, count - i, route, finish);
}

template <class T, std::size_t kChannels>
void TranslateAll(const TranslationMatrix<T>& matrix, const Translation<T>* moves, std::size_t count, std::size_t distance) {
  TranslateTiles<T, kTile / kChannels, kChannels>(matrix, moves, count, InPlace<kChannels>(distance),
                                                  [](const Translation<T>&, Vec<T>* /*sum*/) HWY_ATTR {});
}

// M2M and L2L of the Stokeslets. The matrix does not mix expansions, so moments are moved after it, where that is a few operations per
// vector.
template <class T, std::size_t kChannels>
void TranslateStokes(const TranslationMatrix<T>& matrix, const Translation<T>* moves, std::size_t count, std::size_t distance) {
  TranslateTiles<T, kTile / kChannels, kChannels>(matrix, moves, count, InPlace<kChannels>(distance),
                                                  [](const Translation<T>& t, Vec<T>* sum) HWY_ATTR {
                                                    for (std::size_t a = 0; a < 3; ++a) {
                                                      const Vec<T> shift = hn::Set(Tag<T>(), t.move[a]);
                                                      sum[1 + a] = hn::MulAdd(shift, sum[0], sum[1 + a]);
                                                      sum[7] = hn::MulAdd(shift, sum[4 + a], sum[7]);
                                                    }
                                                  });
}

// M2L of one form of S: W, E_a; or W, P_a, Q; and at last the weighted expansion of local widths.
template <class T, bool kTransposed, bool kWeighted>
void TranslateStokesPairs(const TranslationMatrix<T>& matrix, const Translation<T>* moves, std::size_t count, std::size_t distance) {
  constexpr std::size_t kChannels = (kTransposed ? 5 : 4) + (kWeighted ? 1 : 0);
  Route<kChannels> route;
  for (std::size_t k = 0; k < kChannels; ++k) route.from[k] = route.to[k] = (k + (kTransposed && k > 0 ? 3 : 0)) * distance;
  if (kTransposed) route.to[0] = kTransposedWinding * distance;
  if (kWeighted) {
    route.from[kChannels - 1] = kStokesMultipoles * distance;
    route.to[kChannels - 1] = kStokesLocals * distance;
  }
  TranslateTiles<T, kTile / kChannels, kChannels>(matrix, moves, count, route, [](const Translation<T>& t, Vec<T>* sum) HWY_ATTR {
    for (std::size_t a = 0; a < 3; ++a) {
      Vec<T>& moment = sum[kTransposed ? 4 : 1 + a];
      moment = hn::MulAdd(hn::Set(Tag<T>(), t.move[a]), sum[kTransposed ? 1 + a : 0], moment);
    }
  });
}

template <class T>
void Translate(const TranslationMatrix<T>& matrix, const Translation<T>* moves, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved) {
  static_assert(kStokesLocals == kStokesMultipoles + 1);
  const bool weighted = channels > kStokesMultipoles;
  switch (moved) {
    case Moved::kStokes:
      if (channels == kStokesMultipoles) return TranslateStokes<T, kStokesMultipoles>(matrix, moves, count, distance);
      if (channels == kStokesLocals) return TranslateStokes<T, kStokesLocals>(matrix, moves, count, distance);
      return TranslateStokes<T, kStokesLocals + 1>(matrix, moves, count, distance);
    case Moved::kStokesForward:
      if (weighted) return TranslateStokesPairs<T, false, true>(matrix, moves, count, distance);
      return TranslateStokesPairs<T, false, false>(matrix, moves, count, distance);
    case Moved::kStokesTransposed:
      if (weighted) return TranslateStokesPairs<T, true, true>(matrix, moves, count, distance);
      return TranslateStokesPairs<T, true, false>(matrix, moves, count, distance);
    case Moved::kAll:
      if (channels == 1) return TranslateAll<T, 1>(matrix, moves, count, distance);
      if (channels == 4) return TranslateAll<T, 4>(matrix, moves, count, distance);
      return TranslateAll<T, 9>(matrix, moves, count, distance);
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
