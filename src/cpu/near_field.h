// Pair sums by SIMD: targets in the lanes, sources broadcast. One instruction set per machine, chosen at run time (Highway).
//
// All kernels are unnormalised (without 1/(4 pi)). Precision T: float, flushed to double every few source runs, or double throughout.
// Relative error of one kernel evaluation: 1e-6 (float), 1e-14 (double), see docs/math.md, "Mollified kernels by polynomials".
#pragma once

#include <cstddef>
#include <cstdint>

namespace g3r::cpu {

/// Targets come in blocks of this many lanes; the tail of a block repeats its last point.
inline constexpr std::size_t kLanes = 16;

/// What is summed; F = floats per source record after x, y, z; C = channels of the result; U = channels of target data.
enum class NearForm {
  kGreen,            ///< eta, then (q_k, u_k) for k < K     F = 3 + 2K  C = K      Phi q_k + u_k g (r.eta)
  kGreenAdjoint,     ///< Q_k for k < K                      F = K       C = K + 3  Phi Q_k, and g r sum_k u_k(target) Q_k; U = K
  kStokesWinding,    ///< eta                                F = 3       C = 4      S eta (3), W eta
  kWindingGradient,  ///< eta                                F = 3       C = 3      g eta - b r (r.eta)
};

/// A run of consecutive sources, and what to subtract from target coordinates so that both are relative to the same centre.
template <class T>
struct SourceRun {
  std::uint32_t begin;
  std::uint32_t count;
  T shift[3];
};

/// One group of target blocks against a list of source runs.
template <class T>
struct NearTask {
  NearForm form;
  int batch;                ///< K: 1, 4 or 9; ignored by forms without K
  const T* records;         ///< source records: x y z [squared width if local_widths] F values
  std::size_t record_size;  ///< in T
  const SourceRun<T>* runs;
  std::size_t run_count;
  const T* x;  ///< target coordinates, block_count x kLanes
  const T* y;
  const T* z;
  const T* width_squared;  ///< block_count x kLanes, only with local_widths
  const T* u;              ///< block_count x U x kLanes
  std::size_t block_count;
  T uniform_width_squared;  ///< without local_widths
  bool local_widths;        ///< pairs use the mean of both squared widths
  double* out;              ///< block_count x C x kLanes, overwritten
};

/// Evaluates a task. Thread safe; the result does not depend on anything but the task.
void near_field(const NearTask<float>& task);
void near_field(const NearTask<double>& task);

/// Name of the instruction set in use, for example "AVX3".
const char* instruction_set();

}  // namespace g3r::cpu
