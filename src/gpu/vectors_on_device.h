// The vectors of an iterative solve on a device: what the solver does with them, and what is between two sums of a product with its matrix
// (solve/energy_system.h, solve/green_system.h). Internal to src/sum and src/gpu.
#pragma once

#include "gpu/device.h"

#include <g3r/points.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace g3r::gpu {

/// Vectors of N x 3 doubles, by number, and the roots sqrt(m_i) of the points. For sums in T; the device has doubles. All within
/// alone() of the device. Every function throws DeviceError.
template <class T>
class VectorsOnDevice {
 public:
  /// `roots`: N, or empty for ones. Allocates 24 bytes a point for each of `vectors`, which are not set to anything, and 8 for roots.
  VectorsOnDevice(Device& device, std::size_t points, std::size_t vectors, const std::vector<double>& roots);

  void write(std::size_t to, const std::vector<Vec3>& values);
  [[nodiscard]] std::vector<Vec3> read(std::size_t from);
  /// Sum over all numbers in a fixed order.
  [[nodiscard]] double dot(std::size_t a, std::size_t b);
  /// y = scale y + factor x; y may be not set to anything where scale is 0.
  void combine(std::size_t y, double scale, double factor, std::size_t x);

  /// Values of the sources for S and W of D x, D = diag(roots): three fields, `stride` apart.
  void fill_vectors(std::size_t x, std::size_t stride, const Buffer& values);
  /// `sums`: S and W. product = S; values for the adjoint: D^2 W.
  void take_stokes_winding(const Buffer& sums, std::size_t product, std::size_t stride, const Buffer& values);
  /// `sums`: of the adjoint. product = D (product + weight W^T) + damping x
  void add_winding_adjoint(const Buffer& sums, double weight, double damping, std::size_t x, std::size_t product);

  /// Harmonics for the products below, K of them: N x K values and gradients, row-major. 4 K numbers of T a point.
  void set_harmonics(std::size_t count, const std::vector<double>& value, const std::vector<Vec3>& gradient);
  /// Some of them, for a kernel of `batch`.
  struct Batch {
    std::size_t first, count, batch;
  };
  /// Values of the sources for A[u_k] x.
  void fill_green(std::size_t x, const Batch& batch, std::size_t stride, const Buffer& values);
  /// `sums`: A[u_k] x. Values of sources and targets for the adjoint.
  void take_green(const Buffer& sums, const Batch& batch, std::size_t stride, const Buffer& values, const Buffer& of_targets);
  /// `sums`: of the adjoint. product += sum_k A[u_k]^T A[u_k] x; product = for the first batch.
  void add_green_adjoint(const Buffer& sums, const Batch& batch, std::size_t product);

 private:
  void launch(const char* kernel, std::size_t items, const std::vector<Argument>& arguments);

  Device& device_;
  std::size_t points_;
  std::vector<std::unique_ptr<Buffer>> vectors_;
  std::unique_ptr<Buffer> roots_;  // null: ones
  std::unique_ptr<Buffer> of_block_;
  std::unique_ptr<Buffer> harmonics_, gradients_;  // fields of N: K, and 3 K
};

extern template class VectorsOnDevice<float>;
extern template class VectorsOnDevice<double>;

}  // namespace g3r::gpu
