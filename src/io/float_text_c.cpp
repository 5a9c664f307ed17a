// For standard libraries without std::from_chars and std::to_chars of floating point numbers (LLVM's up to 19). The C library has to write
// a decimal point in every locale, as musl does.
#include "io/float_text.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

namespace g3r::io {
namespace {

constexpr int kLongest = 64;  // characters of one number: the longest, an integer below 1e22 or 17 digits with sign and exponent, has 24

bool is_digit(char c) { return c >= '0' && c <= '9'; }

const char* skip_digits(const char* at, const char* last) {
  while (at != last && is_digit(*at)) ++at;
  return at;
}

// The end of digits[.digits][e[sign]digits]; `first` where there is no digit.
const char* end_of_decimal(const char* first, const char* last) {
  const char* end = skip_digits(first, last);
  bool any = end != first;
  if (end != last && *end == '.') {
    const char* fraction = skip_digits(end + 1, last);
    any = any || fraction != end + 1;
    end = fraction;
  }
  if (!any) return first;
  if (end == last || (*end != 'e' && *end != 'E')) return end;
  const char* exponent = end + 1;
  if (exponent != last && (*exponent == '+' || *exponent == '-')) ++exponent;
  const char* digits = skip_digits(exponent, last);
  return digits != exponent ? digits : end;
}

// Whether the text begins with `word`, in small letters, in whatever case.
bool begins_with(std::string_view text, std::string_view word) {
  if (text.size() < word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if ((text[i] | 0x20) != word[i]) return false;
  }
  return true;
}

// "inf", "infinity", "nan", "nan(letters)": their length and value, 0 if it is none of them.
std::size_t parse_name(std::string_view text, double& value) {
  if (begins_with(text, "inf")) {
    value = std::numeric_limits<double>::infinity();
    return begins_with(text, "infinity") ? 8 : 3;
  }
  if (!begins_with(text, "nan")) return 0;
  value = std::numeric_limits<double>::quiet_NaN();
  std::size_t end = 3;
  if (end == text.size() || text[end] != '(') return end;
  const auto is_inside = [](char c) { return is_digit(c) || c == '_' || ((c | 0x20) >= 'a' && (c | 0x20) <= 'z'); };
  do ++end;
  while (end < text.size() && is_inside(text[end]));
  return end < text.size() && text[end] == ')' ? end + 1 : 3;
}

// Decimal digits without trailing zeros, and the exponent of the first one.
struct Decimal {
  std::string digits;
  int exponent = 0;
};

// Powers of two, whose neighbours are not equally far, may get a digit more than they need.
template <class T>
Decimal shortest(T magnitude) {
  // What has that few digits comes out of a normal number as it went in.
  const int fewest = magnitude < std::numeric_limits<T>::min() ? 1 : std::numeric_limits<T>::digits10;
  char text[kLongest];
  for (int count = fewest;; ++count) {
    std::snprintf(text, sizeof text, "%.*e", count - 1, static_cast<double>(magnitude));
    T back;
    if constexpr (sizeof(T) == sizeof(float)) {
      back = std::strtof(text, nullptr);
    } else {
      back = std::strtod(text, nullptr);
    }
    if (back == magnitude || count == std::numeric_limits<T>::max_digits10) break;
  }
  const char* e = std::strchr(text, 'e');
  Decimal decimal{{}, std::atoi(e + 1)};
  for (const char* c = text; c != e; ++c) {
    if (is_digit(*c)) decimal.digits += *c;
  }
  decimal.digits.erase(decimal.digits.find_last_not_of('0') + 1);
  return decimal;
}

std::string scientific(const Decimal& decimal) {
  std::string text = decimal.digits.substr(0, 1);
  if (decimal.digits.size() > 1) text.append(1, '.').append(decimal.digits, 1);
  const int size = std::abs(decimal.exponent);
  return text + (decimal.exponent < 0 ? "e-" : "e+") + (size < 10 ? "0" : "") + std::to_string(size);
}

// Of integers all digits, which are more than the shortest ones beyond 2^53.
std::string fixed(const Decimal& decimal, double magnitude) {
  const int count = static_cast<int>(decimal.digits.size());
  if (decimal.exponent < 0) return std::string("0.").append(static_cast<std::size_t>(-decimal.exponent - 1), '0').append(decimal.digits);
  if (decimal.exponent < count - 1) {
    const auto point = static_cast<std::size_t>(decimal.exponent + 1);
    return std::string(decimal.digits, 0, point).append(1, '.').append(decimal.digits, point);
  }
  char text[kLongest];
  std::snprintf(text, sizeof text, "%.0f", magnitude);
  return text;
}

template <class T>
std::string to_text(T value) {
  const std::string sign = std::signbit(value) ? "-" : "";
  if (std::isnan(value)) return sign + "nan";
  if (std::isinf(value)) return sign + "inf";
  if (value == 0) return sign + "0";
  const T magnitude = std::abs(value);
  const Decimal decimal = shortest(magnitude);
  const std::string with_exponent = scientific(decimal);
  if (std::abs(decimal.exponent) > kLongest / 2) return sign + with_exponent;
  const std::string without = fixed(decimal, static_cast<double>(magnitude));
  return sign + (without.size() <= with_exponent.size() ? without : with_exponent);
}

std::to_chars_result copy(const std::string& text, char* first, char* last) {
  if (last - first < static_cast<std::ptrdiff_t>(text.size())) return {last, std::errc::value_too_large};
  return {std::copy(text.begin(), text.end(), first), std::errc()};
}

}  // namespace

std::from_chars_result number_from_chars(const char* first, const char* last, double& value) {
  const bool negative = first != last && *first == '-';
  const char* begin = first + (negative ? 1 : 0);
  double magnitude = 0;
  const std::size_t name = parse_name({begin, static_cast<std::size_t>(last - begin)}, magnitude);
  const char* end = name > 0 ? begin + name : end_of_decimal(begin, last);
  if (end == begin) return {first, std::errc::invalid_argument};
  if (name == 0) {
    const std::string digits(begin, end);  // ends with a zero byte, which the token does not
    magnitude = std::strtod(digits.c_str(), nullptr);
    const std::string_view mantissa = std::string_view(digits).substr(0, digits.find_first_of("eE"));
    const bool is_zero = mantissa.find_first_of("123456789") == std::string_view::npos;
    if (std::isinf(magnitude) || (magnitude == 0 && !is_zero)) return {end, std::errc::result_out_of_range};
  }
  value = negative ? -magnitude : magnitude;
  return {end, std::errc()};
}

std::to_chars_result number_to_chars(char* first, char* last, double value) { return copy(to_text(value), first, last); }
std::to_chars_result number_to_chars(char* first, char* last, float value) { return copy(to_text(value), first, last); }

}  // namespace g3r::io
