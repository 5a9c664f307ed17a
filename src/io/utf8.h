// Characters of UTF-8. Source: RFC 3629.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace g3r::io {

/// Bytes of the character that a text starts with, and its number in `code`; 0 if the text is empty or does not start with one: spelled
/// longer than need be, half of a pair of surrogates, beyond U+10FFFF, or cut.
std::size_t utf8_length(std::string_view text, unsigned& code);

/// Appends the character with this number, at most 0x10FFFF.
void append_utf8(unsigned code, std::string& text);

}  // namespace g3r::io
