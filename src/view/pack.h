// Numbers as compact bytes in text, read back by page/scene.js.
#pragma once

#include "view/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::view {

/// Base64 of the bytes (RFC 4648, with padding).
std::string base64(const std::vector<std::uint8_t>& bytes);

/// Appends p as three little-endian uint16: 0 at the low corner of the box, 65535 one longest side further.
void append_position(std::vector<std::uint8_t>& out, const Vec3& p, const Box& box);

/// Appends n as two int8 of the octahedral map (Meyer et al., "On floating-point normal vectors", 2010), about 1 degree;
/// (-127, -127) stands for no normal.
void append_normal(std::vector<std::uint8_t>& out, const Vec3& n);

/// Appends a value of [0, 1] as one byte; not finite counts as 0.
void append_unit(std::vector<std::uint8_t>& out, float value);

/// Appends a little-endian uint32.
void append_index(std::vector<std::uint8_t>& out, std::uint32_t index);

}  // namespace g3r::view
