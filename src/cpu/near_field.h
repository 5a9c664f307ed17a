// Pair sums by SIMD: sources in the lanes, targets one by one. One instruction set per machine, chosen at run time (Highway).
//
// All kernels are unnormalised (without 1/(4 pi)). Precision T: float, added in double every 1536 sources or fewer, or double throughout.
// Relative error of one kernel evaluation: 1e-6 (float; b, of the gradient: 5e-6), 1e-14 (double), or up to NearTask::kernel_error (float),
// see docs/math.md, "Mollified kernels by polynomials".
#pragma once

#include <cstddef>
#include <cstdint>

namespace g3r::cpu {

/// Targets are stored in blocks of this many lanes; the tail of a block repeats its last point. Arrays of sources are readable for as many
/// elements past their end.
inline constexpr std::size_t kLanes = 16;

/// What is summed; F = fields per source after x, y, z and the width; C = channels of the result; U = channels of target data.
enum class NearForm {
  kGreen,            ///< eta, then (q_k, u_k) for k < K     F = 3 + 2K  C = K      Phi q_k + u_k g (r.eta)
  kGreenAdjoint,     ///< Q_k for k < K                      F = K       C = K + 3  Phi Q_k, and g r sum_k u_k(target) Q_k; U = K
  kStokesWinding,    ///< eta                                F = 3       C = 4      S eta (3), W eta
  kWinding,          ///< eta                                F = 3       C = 1      g (r.eta)
  kWindingAdjoint,   ///< Q                                  F = 1       C = 3      g r Q
  kWindingGradient,  ///< eta                                F = 3       C = 3      g eta - b r (r.eta)
};

/// A run of consecutive sources, and what to add to their coordinates so that they are relative to the targets' centre.
template <class T>
struct SourceRun {
  std::uint32_t begin;
  std::uint32_t count;
  T shift[3];
};

/// One group of targets against a list of source runs.
template <class T>
struct NearTask {
  NearForm form;
  int batch;                      ///< K: 1, 4 or 9; ignored by forms without K
  const T* places;                ///< x y z of the sources, one after the other; that of source i at [f * stride + i], f = 0, 1, 2
  const T* source_width_squared;  ///< only with local_widths
  const T* values;                ///< F fields, as places
  std::size_t stride;
  const SourceRun<T>* runs;
  std::size_t run_count;
  std::size_t count;  ///< targets
  const T* x;         ///< target coordinates
  const T* y;
  const T* z;
  const T* width_squared;   ///< of the targets, only with local_widths
  const T* u;               ///< blocks x U x kLanes
  T uniform_width_squared;  ///< without local_widths
  bool local_widths;        ///< pairs use the mean of both squared widths
  T reach;                  ///< widths from which on the kernels are plain powers; at most kMollifierReach<T>
  double kernel_error;      ///< relative error that an evaluation of the kernels may have
  double* out;              ///< blocks x C x kLanes, overwritten
  T* workspace;             ///< near_workspace(fields) elements, aligned
};

inline constexpr std::size_t kMostFields = 4 + 3 + 2 * 9;  ///< geometry with widths, and kGreen of 9 harmonics
inline constexpr std::size_t kGatheredValues = 6144;       ///< at a time: 24 KiB of floats, which stay in the first cache

/// Sources gathered at a time: what sums in T are added up over, which bounds their rounding. A multiple of kLanes.
constexpr std::size_t gathered_sources(std::size_t fields) { return kGatheredValues / fields / kLanes * kLanes; }

/// Elements of T that a NearTask's workspace needs. `fields`: of a source, geometry included.
constexpr std::size_t near_workspace(std::size_t fields) { return fields * (gathered_sources(fields) + kLanes); }

/// Evaluates a task. Thread safe; the result does not depend on anything but the task.
void near_field(const NearTask<float>& task);
void near_field(const NearTask<double>& task);

/// Name of the instruction set in use, for example "AVX3".
const char* instruction_set();

}  // namespace g3r::cpu
