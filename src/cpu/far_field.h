// Expansions by SIMD: points to multipoles, locals to points. docs/math.md, "Expansions".
// The same forms as in cpu/near_field.h; unnormalised kernels (without 1/(4 pi)); T is float or double.
#pragma once

#include "cpu/near_field.h"

#include <cstddef>

namespace g3r::cpu {

/// Expansions a form carries: K for kGreen and kGreenAdjoint, 1 for the winding forms. The multipoles of kStokesWinding are
///   0: W   1..3: E_a = eta_a + (y-c)_a dipole   4..6: P_a = eta_a   7: Q = (y-c) . eta   8: W of width^2 eta (only with local widths)
/// S can be had from W and E or, transposed, from P and Q. Every pair of nodes uses one of the two and the pair turned round the other, so
/// that S is symmetric to rounding although expansions are truncated. Its locals therefore are
///   0: W of the pairs that use E   1..7: as above   8: W of the other pairs   9: W of width^2 eta
inline constexpr std::size_t kStokesMultipoles = 8;
inline constexpr std::size_t kStokesLocals = 9;
inline constexpr std::size_t kTransposedWinding = 8;

/// Length of one expansion in memory: the coefficients padded to whole vectors.
constexpr std::size_t padded_count(std::size_t coefficients) { return (coefficients + kLanes - 1) / kLanes * kLanes; }

/// One leaf: its points relative to its centre.
template <class T>
struct LeafTask {
  NearForm form;
  int batch;  ///< K
  int order;  ///< of the expansions
  T half_side;
  bool local_widths;
  T uniform_width_squared;
  std::size_t stride;  ///< length of one expansion
  // points to multipole
  const T* places;  ///< of its sources, as in NearTask
  const T* source_width_squared;
  const T* values;
  std::size_t value_count;  ///< fields
  std::size_t field_stride;
  std::size_t count;     ///< points
  std::size_t channels;  ///< of the multipole
  T* multipole;          ///< channels x stride, overwritten
  // local to points
  const T* local;  ///< of all channels of the form, stride apart
  const T* x;      ///< target blocks: block_count x kLanes
  const T* y;
  const T* z;
  const T* width_squared;
  const T* u;
  std::size_t block_count;
  double* out;   ///< added to
  T* workspace;  ///< leaf_workspace() elements
};

/// Elements of T that a LeafTask's workspace needs.
std::size_t leaf_workspace(std::size_t coefficients, std::size_t channels);

void points_to_multipole(const LeafTask<float>& task);
void points_to_multipole(const LeafTask<double>& task);
void local_to_points(const LeafTask<float>& task);
void local_to_points(const LeafTask<double>& task);

}  // namespace g3r::cpu
