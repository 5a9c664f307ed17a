#include "io/number_type.h"

#include <algorithm>
#include <cmath>

namespace g3r::io {

namespace {

template <class T>
void store_integer(double value, char* bytes) {
  constexpr auto kLow = static_cast<double>(std::numeric_limits<T>::min());
  constexpr auto kHigh = static_cast<double>(std::numeric_limits<T>::max());  // 2^63 or 2^64 for 64 bits: rounded up
  T number = 0;
  const double rounded = std::nearbyint(value);
  if (rounded >= kHigh) {
    number = std::numeric_limits<T>::max();
  } else if (rounded <= kLow) {
    number = std::numeric_limits<T>::min();
  } else if (!std::isnan(rounded)) {
    number = static_cast<T>(rounded);
  }
  std::memcpy(bytes, &number, sizeof number);
}

// A double beyond float's range becomes infinite: the cast alone would be undefined.
float to_float(double value) {
  if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max()) && std::isfinite(value)) {
    constexpr double kHalfway = 0x1.ffffffp127;  // rounds to infinity from here on
    if (std::abs(value) >= kHalfway) return std::copysign(std::numeric_limits<float>::infinity(), value > 0 ? 1.0F : -1.0F);
    return std::copysign(std::numeric_limits<float>::max(), value > 0 ? 1.0F : -1.0F);
  }
  return static_cast<float>(value);
}

}  // namespace

double load_as_double(Type type, const char* bytes) {
  switch (type) {
    case Type::kInt8:
      return load<std::int8_t>(bytes);
    case Type::kUint8:
      return load<std::uint8_t>(bytes);
    case Type::kInt16:
      return load<std::int16_t>(bytes);
    case Type::kUint16:
      return load<std::uint16_t>(bytes);
    case Type::kInt32:
      return load<std::int32_t>(bytes);
    case Type::kUint32:
      return load<std::uint32_t>(bytes);
    case Type::kInt64:
      return static_cast<double>(load<std::int64_t>(bytes));
    case Type::kUint64:
      return static_cast<double>(load<std::uint64_t>(bytes));
    case Type::kFloat32:
      return load<float>(bytes);
    case Type::kFloat64:
      break;
  }
  return load<double>(bytes);
}

void store_double(Type type, double value, char* bytes) {
  switch (type) {
    case Type::kInt8:
      return store_integer<std::int8_t>(value, bytes);
    case Type::kUint8:
      return store_integer<std::uint8_t>(value, bytes);
    case Type::kInt16:
      return store_integer<std::int16_t>(value, bytes);
    case Type::kUint16:
      return store_integer<std::uint16_t>(value, bytes);
    case Type::kInt32:
      return store_integer<std::int32_t>(value, bytes);
    case Type::kUint32:
      return store_integer<std::uint32_t>(value, bytes);
    case Type::kInt64:
      return store_integer<std::int64_t>(value, bytes);
    case Type::kUint64:
      return store_integer<std::uint64_t>(value, bytes);
    case Type::kFloat32: {
      const float number = to_float(value);
      std::memcpy(bytes, &number, sizeof number);
      return;
    }
    case Type::kFloat64:
      std::memcpy(bytes, &value, sizeof value);
  }
}

void append_double(Type type, double value, std::string& bytes) {
  char stored[8];
  store_double(type, value, stored);
  bytes.append(stored, size_of(type));
}

std::optional<Type> type_of(NumberKind kind, std::uint64_t bytes) {
  switch (bytes) {
    case 1:
      if (kind == NumberKind::kFloat) return std::nullopt;
      return kind == NumberKind::kSigned ? Type::kInt8 : Type::kUint8;
    case 2:
      if (kind == NumberKind::kFloat) return std::nullopt;
      return kind == NumberKind::kSigned ? Type::kInt16 : Type::kUint16;
    case 4:
      return kind == NumberKind::kFloat ? Type::kFloat32 : kind == NumberKind::kSigned ? Type::kInt32 : Type::kUint32;
    case 8:
      return kind == NumberKind::kFloat ? Type::kFloat64 : kind == NumberKind::kSigned ? Type::kInt64 : Type::kUint64;
    default:
      return std::nullopt;
  }
}

void swap_bytes(Type type, char* bytes) { std::reverse(bytes, bytes + size_of(type)); }

}  // namespace g3r::io
