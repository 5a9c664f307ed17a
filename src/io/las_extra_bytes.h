// The properties of LAS points that are no fields of the format: a variable length record describes each of them, in 192 bytes.
// Source: ASPRS, "LAS Specification 1.4 - R15", 2019, "Extra Bytes VLR".
#pragma once

#include "io/las.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace g3r::io {

inline constexpr std::size_t kLasNameAt = 4;      ///< byte offset of the name in a descriptor
inline constexpr std::size_t kLasNameBytes = 32;  ///< of a descriptor

/// Adds the fields that descriptors describe to a header that has its record_bytes and standard fields, and sets undescribed_bytes. Types
/// 11 to 30 are arrays of two or three numbers of types 1 to 10: a field each. What does not fit in a record, and all after it, is not
/// described.
void read_extra_bytes(std::string_view descriptors, LasHeader& header);

/// LAS's number of a type in a descriptor, 1 to 10.
unsigned las_type_number(Type type);

/// A descriptor; type 0 with `options` bytes stands for bytes without meaning.
std::string las_descriptor(const std::string& name, unsigned type, std::size_t options);

/// The header of the variable length record that holds `length` bytes of descriptors, at most 65535.
std::string las_extra_vlr(std::size_t length);

}  // namespace g3r::io
