#include "io/ply_types.h"

#include <algorithm>

namespace g3r::io {

namespace {

struct TypeName {
  const char* name;
  Type type;
};

// Of two names of a type the first is written, which all programs know.
constexpr TypeName kTypes[] = {
    {"char", Type::kInt8},     {"int8", Type::kInt8},       {"uchar", Type::kUint8},    {"uint8", Type::kUint8},
    {"short", Type::kInt16},   {"int16", Type::kInt16},     {"ushort", Type::kUint16},  {"uint16", Type::kUint16},
    {"int", Type::kInt32},     {"int32", Type::kInt32},     {"uint", Type::kUint32},    {"uint32", Type::kUint32},
    {"float", Type::kFloat32}, {"float32", Type::kFloat32}, {"double", Type::kFloat64}, {"float64", Type::kFloat64}};

template <class Is>
const TypeName* find_type(const Is& is) {
  const TypeName* const found = std::find_if(std::begin(kTypes), std::end(kTypes), is);
  return found == std::end(kTypes) ? nullptr : found;
}

}  // namespace

std::optional<Type> ply_type_of(std::string_view name) {
  const TypeName* const found = find_type([&](const TypeName& known) { return known.name == name; });
  if (found == nullptr) return std::nullopt;
  return found->type;
}

const char* ply_type_name(Type type) {
  const TypeName* const found = find_type([&](const TypeName& known) { return known.type == type; });
  return found == nullptr ? "double" : found->name;
}

}  // namespace g3r::io
