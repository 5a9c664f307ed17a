// What Highway 1.0 lacks for WebAssembly, whose vectors it gives no doubles: the operations on them that the kernels use. To be included
// after <hwy/highway.h>; empty on other targets.
#pragma once

#include <hwy/highway.h>

#if HWY_TARGET == HWY_WASM

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace hwy::HWY_NAMESPACE {

template <std::size_t N, HWY_IF_LE128(double, N)>
HWY_API Vec128<double, N> Set(Simd<double, N, 0> /* tag */, double value) {
  return {wasm_f64x2_splat(value)};
}
template <std::size_t N>
HWY_API Vec128<double, N> operator+(Vec128<double, N> a, Vec128<double, N> b) {
  return {wasm_f64x2_add(a.raw, b.raw)};
}
template <std::size_t N>
HWY_API Vec128<double, N> operator-(Vec128<double, N> a, Vec128<double, N> b) {
  return {wasm_f64x2_sub(a.raw, b.raw)};
}
template <std::size_t N>
HWY_API Vec128<double, N> operator*(Vec128<double, N> a, Vec128<double, N> b) {
  return {wasm_f64x2_mul(a.raw, b.raw)};
}
template <std::size_t N>
HWY_API Vec128<double, N> operator/(Vec128<double, N> a, Vec128<double, N> b) {
  return {wasm_f64x2_div(a.raw, b.raw)};
}
template <std::size_t N>
HWY_API Mask128<double, N> operator<(Vec128<double, N> a, Vec128<double, N> b) {
  return {wasm_f64x2_lt(a.raw, b.raw)};
}
template <std::size_t N>
HWY_API Vec128<double, N> Sqrt(Vec128<double, N> a) {
  return {wasm_f64x2_sqrt(a.raw)};
}
template <std::size_t N>
HWY_API Vec128<double, N> MulAdd(Vec128<double, N> a, Vec128<double, N> b, Vec128<double, N> add) {
  return a * b + add;
}
template <std::size_t N>
HWY_API Vec128<double, N> NegMulAdd(Vec128<double, N> a, Vec128<double, N> b, Vec128<double, N> add) {
  return add - a * b;
}
template <std::size_t N>
HWY_API Vec128<double, N> MulSub(Vec128<double, N> a, Vec128<double, N> b, Vec128<double, N> sub) {
  return a * b - sub;
}

// The same by name, for calls that name this namespace.
template <std::size_t N>
HWY_API Vec128<double, N> Add(Vec128<double, N> a, Vec128<double, N> b) {
  return a + b;
}
template <std::size_t N>
HWY_API Vec128<double, N> Sub(Vec128<double, N> a, Vec128<double, N> b) {
  return a - b;
}
template <std::size_t N>
HWY_API Vec128<double, N> Mul(Vec128<double, N> a, Vec128<double, N> b) {
  return a * b;
}
template <std::size_t N>
HWY_API Vec128<double, N> Div(Vec128<double, N> a, Vec128<double, N> b) {
  return a / b;
}
template <std::size_t N>
HWY_API Mask128<double, N> Lt(Vec128<double, N> a, Vec128<double, N> b) {
  return a < b;
}

}  // namespace hwy::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
