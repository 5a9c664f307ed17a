// Expansions through matrices by SIMD: multipoles to parents, multipoles to locals, locals to children. docs/math.md, "Expansions".
#pragma once

#include "cpu/far_field.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace g3r::cpu {

/// Columns [first, last) of a matrix.
struct ColumnRange {
  std::uint32_t first;
  std::uint32_t last;
};

/// A matrix acting on expansions. Its rows come in groups of kLanes, padded with zeros, each with a range of columns outside of which it is
/// zero; that of one of two neighbouring groups contains the other's. Data: group after group, column after column, kLanes rows each.
template <class T>
struct TranslationMatrix {
  const T* data;
  const ColumnRange* columns;  ///< of every group
  std::size_t groups;          ///< that are used
  std::uint32_t most_columns;  ///< columns from this one on are left out
};

/// The expansions of one node and those of another that they are added to: each node's one after the other.
template <class T>
struct Translation {
  const T* from;
  T* to;
  const T* signs;         ///< D, +-1 for every coefficient: to += D matrix D from
  std::array<T, 3> move;  ///< old centre - new centre; of kStokesWinding only
};

/// Which expansions are moved.
enum class Moved : std::uint8_t {
  kAll,               ///< each to its own place
  kStokes,            ///< M2M and L2L of kStokesWinding: as kAll, and the moments move with their centre: E_a += move_a W, Q += move . P
  kStokesForward,     ///< M2L of kStokesWinding: W and E,
  kStokesTransposed,  ///< or W, P and Q
};

/// to += D matrix D from, for `channels` expansions (of the source) of `count` translations. `distance`: from one expansion of a node to
/// its next. Every result is the same whatever other translations go with it.
void translate(const TranslationMatrix<float>& matrix, const Translation<float>* translations, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved);
void translate(const TranslationMatrix<double>& matrix, const Translation<double>* translations, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved);

}  // namespace g3r::cpu
