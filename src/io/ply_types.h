// The names that PLY has for types of numbers. Source: Greg Turk, "The PLY Polygon File Format", 1994.
#pragma once

#include "io/number_type.h"

#include <optional>
#include <string_view>

namespace g3r::io {

/// The type of a name, "char" or "int8" ... "double" or "float64"; nothing if PLY has no such type.
std::optional<Type> ply_type_of(std::string_view name);

/// PLY's name of a type: "char" ... "double". 64-bit integers, which PLY lacks, are called "double".
const char* ply_type_name(Type type);

}  // namespace g3r::io
