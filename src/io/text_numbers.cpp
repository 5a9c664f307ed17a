#include "io/text_numbers.h"

#include "io/float_text.h"

#include <algorithm>
#include <limits>

namespace g3r::io {

namespace {

// Whether a decimal literal that from_chars calls out of range is too large (else it is too small).
bool is_too_large(std::string_view token) {
  long exponent = 0;
  const std::size_t e = token.find_first_of("eE");
  if (e != std::string_view::npos) {
    std::string_view digits = token.substr(e + 1);
    const bool negative = !digits.empty() && digits[0] == '-';
    if (!parse_integer(digits, exponent)) return !negative;
  }
  std::string_view mantissa = token.substr(0, e);
  if (!mantissa.empty() && mantissa[0] == '-') mantissa.remove_prefix(1);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t first = mantissa.find_first_of("123456789");
  if (first == std::string_view::npos) return false;
  const auto magnitude = first < point ? static_cast<long>(point - first) : -static_cast<long>(first - point);
  return exponent > -magnitude;  // their sum may be no long
}

// What Microsoft's printf writes for NaN and infinity.
bool parse_microsoft(std::string_view token, double& value) {
  double sign = 1;
  if (!token.empty() && token[0] == '-') {
    sign = -1;
    token.remove_prefix(1);
  }
  if (token.substr(0, 3) != "1.#") return false;
  token.remove_prefix(3);
  const std::size_t end = token.find_last_not_of('0');  // padding of a fixed number of decimals
  token = token.substr(0, end + 1);
  if (token == "INF") {
    value = sign * std::numeric_limits<double>::infinity();
  } else if (token == "QNAN" || token == "IND" || token == "SNAN" || token == "NAN") {
    value = std::numeric_limits<double>::quiet_NaN();
  } else {
    return false;
  }
  return true;
}

template <class T>
void append_float(std::string& text, T value) {
  char digits[32];
  const auto [end, error] = number_to_chars(digits, digits + sizeof digits, value);
  text.append(digits, end);
}

template <class T>
void append_integer(std::string& text, T value) {
  char digits[20];  // of the least std::int64_t
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, end);
}

}  // namespace

bool parse_double(std::string_view token, double& value, bool* overflow) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  const char* last = token.data() + token.size();
  const auto [end, error] = number_from_chars(token.data(), last, value);
  if (end != last) return parse_microsoft(token, value);
  if (error == std::errc::result_out_of_range) {
    const bool large = is_too_large(token);
    value = large ? std::numeric_limits<double>::infinity() : 0.0;
    if (token[0] == '-') value = -value;
    if (overflow != nullptr && large) *overflow = true;
    return true;
  }
  return error == std::errc();
}

std::uint64_t parse_count(const Source& source, std::size_t line, std::string_view token, const std::string& what) {
  std::uint64_t count = 0;
  if (parse_integer(token, count)) return count;
  const bool digits = !token.empty() && token.find_first_not_of("0123456789") == std::string_view::npos;
  const std::string problem = token.empty() ? "found none" : "found " + quote(token);
  const std::string kind = digits                              ? " (count too large, out of range)"
                           : !token.empty() && token[0] == '-' ? " (negative)"
                                                               : " (not a whole number)";
  fail_at_line(source, line, "expected the " + what + " (a count: a decimal number from 0), " + problem + (token.empty() ? "" : kind));
}

std::string expected_number(std::string_view found, const std::string& where) {
  std::string text = "expected a number, found " + quote(found) + where;
  if (found.find(',') != std::string_view::npos) return text + " (a decimal comma? write numbers with a point)";
  if (found.find_first_of("dD") != std::string_view::npos && found.find_first_of("0123456789") == 0) text += " (a Fortran exponent? use E)";
  if (found.find('\0') != std::string_view::npos) text += " (a NUL character)";
  return text;
}

void append_number(std::string& text, double value) { append_float(text, value); }
void append_number(std::string& text, float value) { append_float(text, value); }
void append_number(std::string& text, std::int64_t value) { append_integer(text, value); }
void append_number(std::string& text, std::uint64_t value) { append_integer(text, value); }

std::string number_text(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

std::string number_text(float value) {
  std::string text;
  append_number(text, value);
  return text;
}

}  // namespace g3r::io
