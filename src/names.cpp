#include <g3r/names.h>

#include <charconv>
#include <cmath>
#include <system_error>

namespace g3r {

std::optional<Length> parse_length(std::string_view text) {
  if (text == "auto") return Length{};
  Length length;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, length.value);
  if (error != std::errc() || !std::isfinite(length.value) || length.value < 0) return std::nullopt;
  const auto unit = parse<Length::Unit>(std::string_view(rest, static_cast<std::size_t>(end - rest)));
  if (!unit) return std::nullopt;
  length.unit = *unit;
  return length;
}

}  // namespace g3r
