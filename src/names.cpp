#include <g3r/names.h>

#include <cmath>
#include <system_error>

#include "io/float_text.h"

namespace g3r {

std::optional<Length> parse_length(std::string_view text) {
  if (text == "auto") return Length{};
  Length length;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = io::number_from_chars(text.data(), end, length.value);
  if (error != std::errc() || !std::isfinite(length.value) || length.value < 0) return std::nullopt;
  const auto unit = parse<Length::Unit>(std::string_view(rest, static_cast<std::size_t>(end - rest)));
  if (!unit) return std::nullopt;
  length.unit = *unit;
  return length;
}

std::optional<Vec3> parse_vector(std::string_view text) {
  Vec3 vector{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t a = 0; a < 3; ++a) {
    if (a > 0 && (at == end || *at++ != ',')) return std::nullopt;
    const auto [rest, error] = io::number_from_chars(at, end, vector[a]);
    if (error != std::errc() || !std::isfinite(vector[a])) return std::nullopt;
    at = rest;
  }
  return at == end ? std::optional(vector) : std::nullopt;
}

std::optional<Vec3> parse_direction(std::string_view text) {
  const bool is_signed = !text.empty() && (text.front() == '+' || text.front() == '-');
  const std::string_view axis = text.substr(is_signed ? 1 : 0);
  const std::size_t number = axis.size() == 1 ? std::string_view("xyzXYZ").find(axis[0]) : std::string_view::npos;
  if (number != std::string_view::npos) {
    Vec3 direction{0, 0, 0};
    direction[number % 3] = text.front() == '-' ? -1 : 1;
    return direction;
  }
  const std::optional<Vec3> vector = parse_vector(text);
  return vector && *vector != Vec3{0, 0, 0} ? vector : std::nullopt;
}

}  // namespace g3r
