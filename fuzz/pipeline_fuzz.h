// The form of an input of the pipeline's fuzz target, for it and for the maker of its seeds.
#pragma once

#include <cstddef>

namespace g3r::fuzz {

/// Bytes that choose the coding of the points and the options; all zero: a file, default options.
inline constexpr std::size_t kOptionBytes = 36;

/// What the other bytes are, by the first one.
enum class Coding : unsigned char { kFile, kInteger, kFloat, kDouble };

}  // namespace g3r::fuzz
