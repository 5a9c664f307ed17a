// Numbers as text. They go through from_chars and to_chars (io/float_text.h) only, so the locale never matters.
#pragma once

#include "io/source.h"

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

namespace g3r::io {

/// Whether the token is a number from its first to its last character. NaN and infinity in the usual spellings count; beyond
/// double's range it is infinite or zero and `overflow` is set (it is never cleared). No hexadecimal, no decimal comma, no Fortran D.
bool parse_double(std::string_view token, double& value, bool* overflow = nullptr);

/// The same for a decimal integer of type T; false also when out of range.
template <class T>
bool parse_integer(std::string_view token, T& value) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  return error == std::errc() && end == token.data() + token.size();
}

/// Reads a count from a header. Says what is wrong with it: missing, negative, not a number, too large.
std::uint64_t parse_count(const Source& source, std::size_t line, std::string_view token, const std::string& what);

/// What readers warn of where parse_double() has set `overflow`.
inline constexpr const char* kOverflow = "a number is out of double's range: it is taken as infinite (not finite)";

/// For messages: "expected a number, found "0,5" in column 2 (a decimal comma? write numbers with a point)". `where` stands after what was
/// found.
std::string expected_number(std::string_view found, const std::string& where = "");

/// The shortest text that reads back as the same number.
void append_number(std::string& text, double value);
void append_number(std::string& text, float value);
void append_number(std::string& text, std::int64_t value);
void append_number(std::string& text, std::uint64_t value);
std::string number_text(double value);
std::string number_text(float value);

}  // namespace g3r::io
