#include "gpu/vectors_on_device.h"

#include "cpu/parallel.h"
#include "gpu/kernel_source.h"
#include "gpu/lists_on_device.h"

#include <cstring>

namespace g3r::gpu {
namespace {

std::size_t up_to(std::size_t items, std::size_t each) { return (items + each - 1) / each; }

}  // namespace

template <class T>
VectorsOnDevice<T>::VectorsOnDevice(Device& device, std::size_t points, std::size_t vectors, const std::vector<double>& roots)
    : device_(device), points_(points), vectors_(vectors), of_block_(device.allocate(up_to(3 * points, kDotBlock) * sizeof(double))) {
  for (std::unique_ptr<Buffer>& vector : vectors_) vector = device.allocate(points * sizeof(Vec3));
  if (!roots.empty()) roots_ = upload(device, roots);
}

template <class T>
void VectorsOnDevice<T>::launch(const char* kernel, std::size_t items, const std::vector<Argument>& arguments) {
  Program& program = device_.program(vectors_source(sizeof(T) == sizeof(double), device_.info().software));
  const std::size_t group = vectors_group(device_.info().software);
  device_.launch(program.kernel(kernel), up_to(items, group), group, arguments, 0);
}

template <class T>
void VectorsOnDevice<T>::write(std::size_t to, const std::vector<Vec3>& values) {
  device_.write(*vectors_[to], 0, values.data(), vectors_[to]->bytes());
}

template <class T>
std::vector<Vec3> VectorsOnDevice<T>::read(std::size_t from) {
  std::vector<Vec3> out(points_);
  auto* const bytes = reinterpret_cast<unsigned char*>(out.data());
  device_.read(*vectors_[from], vectors_[from]->bytes(), sizeof(Vec3),
               [&](std::size_t offset, const unsigned char* data, std::size_t count) { std::memcpy(bytes + offset, data, count); });
  return out;
}

template <class T>
double VectorsOnDevice<T>::dot(std::size_t a, std::size_t b) {
  const std::size_t blocks = up_to(3 * points_, kDotBlock);
  launch("dot_of_blocks", blocks * vectors_group(device_.info().software), {narrow(points_), *vectors_[a], *vectors_[b], *of_block_});
  double sum = 0;
  device_.read(*of_block_, blocks * sizeof(double), sizeof(double), [&](std::size_t, const unsigned char* data, std::size_t bytes) {
    for (std::size_t k = 0; k < bytes; k += sizeof(double)) {
      double of_one = 0;
      std::memcpy(&of_one, data + k, sizeof of_one);
      sum += of_one;
    }
  });
  return sum;
}

template <class T>
void VectorsOnDevice<T>::combine(std::size_t y, double scale, double factor, std::size_t x) {
  launch("combine", points_, {narrow(points_), scale, factor, *vectors_[x], *vectors_[y]});
}

template <class T>
void VectorsOnDevice<T>::fill_vectors(std::size_t x, std::size_t stride, const Buffer& values) {
  const Buffer& roots = roots_ ? *roots_ : *of_block_;
  launch("fill_vectors", stride, {narrow(points_), narrow(stride), *vectors_[x], roots, roots_ ? 1 : 0, values});
}

template <class T>
void VectorsOnDevice<T>::take_stokes_winding(const Buffer& sums, std::size_t product, std::size_t stride, const Buffer& values) {
  const Buffer& roots = roots_ ? *roots_ : *of_block_;
  launch("take_stokes_winding", stride, {narrow(points_), narrow(stride), sums, roots, roots_ ? 1 : 0, values, *vectors_[product]});
}

template <class T>
void VectorsOnDevice<T>::add_winding_adjoint(const Buffer& sums, double weight, double damping, std::size_t x, std::size_t product) {
  const Buffer& roots = roots_ ? *roots_ : *of_block_;
  launch("add_winding_adjoint", points_, {narrow(points_), sums, weight, damping, roots, roots_ ? 1 : 0, *vectors_[x], *vectors_[product]});
}

template <class T>
void VectorsOnDevice<T>::set_harmonics(std::size_t count, const std::vector<double>& value, const std::vector<Vec3>& gradient) {
  std::vector<T> field(points_);
  harmonics_ = device_.allocate(count * points_ * sizeof(T));
  gradients_ = device_.allocate(3 * count * points_ * sizeof(T));
  const auto write_field = [&](const Buffer& to, std::size_t number, const auto& at) {
    parallel::for_all(points_, [&](std::size_t i) { field[i] = static_cast<T>(at(i)); });
    device_.write(to, number * points_ * sizeof(T), field.data(), points_ * sizeof(T));
  };
  for (std::size_t k = 0; k < count; ++k) {
    write_field(*harmonics_, k, [&](std::size_t i) { return value[i * count + k]; });
    for (std::size_t a = 0; a < 3; ++a) write_field(*gradients_, 3 * k + a, [&](std::size_t i) { return gradient[i * count + k][a]; });
  }
}

template <class T>
void VectorsOnDevice<T>::fill_green(std::size_t x, const Batch& b, std::size_t stride, const Buffer& values) {
  launch(
      "fill_green", stride,
      {narrow(points_), narrow(stride), *vectors_[x], *harmonics_, *gradients_, as_int(b.first), as_int(b.count), as_int(b.batch), values});
}

template <class T>
void VectorsOnDevice<T>::take_green(const Buffer& sums, const Batch& b, std::size_t stride, const Buffer& values,
                                    const Buffer& of_targets) {
  launch("take_green", stride,
         {narrow(points_), narrow(stride), sums, *harmonics_, as_int(b.first), as_int(b.count), as_int(b.batch), values, of_targets});
}

template <class T>
void VectorsOnDevice<T>::add_green_adjoint(const Buffer& sums, const Batch& b, std::size_t product) {
  launch("add_green_adjoint", points_,
         {narrow(points_), sums, *gradients_, as_int(b.first), as_int(b.count), as_int(b.batch), *vectors_[product]});
}

template class VectorsOnDevice<float>;
template class VectorsOnDevice<double>;

}  // namespace g3r::gpu
