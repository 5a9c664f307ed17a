// NumPy arrays in without a copy, vectors out without a copy.
#pragma once

#include <g3r/error.h>
#include <g3r/points.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

namespace g3r::python {

namespace nb = nanobind;

/// (n, 3) float32 or float64 with adjacent x, y, z; rows may be any distance apart.
using PointsArray = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cpu>;
template <class T>
using Rows = nb::ndarray<const T, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
template <class T>
using Values = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

inline PointsView points_view(const PointsArray& array) {
  const bool single = array.dtype() == nb::dtype<float>();
  if (!single && array.dtype() != nb::dtype<double>()) throw InvalidInput("points must be float32 or float64");
  if (array.shape(1) != 3) throw InvalidInput("points must be an array of shape (n, 3)");
  if (array.shape(0) > 0 && array.stride(1) != 1) throw InvalidInput("x, y, z of a point must be adjacent");
  const std::ptrdiff_t size = single ? 4 : 8;
  PointsView view(array.data(), array.shape(0), single ? Scalar::kFloat32 : Scalar::kFloat64);
  view.stride_bytes = array.stride(0) * size;  // 0 is a legal stride: the same point n times
  return view;
}

/// A copy, for parts of the library that own their points.
inline std::vector<Vec3> copy_points(const std::optional<PointsArray>& array) {
  std::vector<Vec3> out;
  if (!array) return out;
  const PointsView view = points_view(*array);
  out.reserve(view.count);
  for (std::size_t i = 0; i < view.count; ++i) out.push_back(view[i]);
  return out;
}

template <class T>
std::vector<std::array<T, 3>> copy_rows(const std::optional<Rows<T>>& array) {
  std::vector<std::array<T, 3>> out;
  if (!array) return out;
  const T* data = array->data();
  for (std::size_t i = 0; i < array->shape(0); ++i) out.push_back({data[3 * i], data[3 * i + 1], data[3 * i + 2]});
  return out;
}

template <class T>
std::vector<T> copy_values(const std::optional<Values<T>>& array) {
  if (!array) return {};
  return {array->data(), array->data() + array->shape(0)};
}

/// The (n, 3) or (n,) array of a vector that moves to Python.
template <class T>
auto give_rows(std::vector<std::array<T, 3>>&& rows) {
  auto* owned = new std::vector<std::array<T, 3>>(std::move(rows));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<std::array<T, 3>>*>(p); });
  return nb::ndarray<nb::numpy, T, nb::ndim<2>>(owned->data(), {owned->size(), 3}, owner);
}

template <class T>
auto give_values(std::vector<T>&& values) {
  auto* owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::ndarray<nb::numpy, T, nb::ndim<1>>(owned->data(), {owned->size()}, owner);
}

}  // namespace g3r::python
