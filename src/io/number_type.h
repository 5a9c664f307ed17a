// The types of the numbers that files hold, and the numbers as doubles and back.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <string>

namespace g3r::io {

static_assert(std::endian::native == std::endian::little, "numbers are kept in memory as little-endian bytes");

/// Type of one stored number.
enum class Type : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

/// Bytes of one number.
constexpr std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

constexpr bool is_float(Type type) { return type == Type::kFloat32 || type == Type::kFloat64; }

/// How a number is stored, apart from its size.
enum class NumberKind : std::uint8_t { kSigned, kUnsigned, kFloat };

/// The type of numbers of so many bytes; nothing if there is none.
std::optional<Type> type_of(NumberKind kind, std::uint64_t bytes);

template <class T>
T load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Bytes of so many items of `each` bytes: std::bad_alloc where a size does not hold them, as one of 32 bits does not hold all of what a
/// sound file may say.
inline std::size_t bytes_of(std::uint64_t count, std::uint64_t each) {
  if (each != 0 && count > std::numeric_limits<std::size_t>::max() / each) throw std::bad_alloc();
  return static_cast<std::size_t>(count * each);
}

/// What has the bytes of `from`: std::bit_cast, which standard libraries of C++20 did not have from the start.
template <class To, class From>
To bits_as(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To value;
  std::memcpy(&value, &from, sizeof value);
  return value;
}

/// The number at `bytes` as a double (64-bit integers beyond 2^53 are rounded).
double load_as_double(Type type, const char* bytes);

/// Stores `value` at `bytes`: rounded to nearest and kept within range for integers (0 for NaN), to nearest for float.
void store_double(Type type, double value, char* bytes);

/// The same after the last of `bytes`.
void append_double(Type type, double value, std::string& bytes);

/// Turns the number at `bytes` from big-endian to little-endian or back.
void swap_bytes(Type type, char* bytes);

}  // namespace g3r::io
