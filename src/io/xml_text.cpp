#include "io/xml_text.h"

#include "io/utf8.h"
#include "io/xml.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <utility>

namespace g3r::io {

namespace {

bool is_character(unsigned c) {  // [2]
  return c == '\t' || c == '\n' || c == '\r' || (c >= 0x20 && c < 0xD800) || (c >= 0xE000 && c < 0xFFFE) || (c >= 0x10000 && c < 0x110000);
}

// The character that "#38" or "#x26" names [66]; `digits` are behind the #.
unsigned referenced(std::string_view digits, std::size_t at) {
  const int base = digits.starts_with('x') ? 16 : 10;
  if (base == 16) digits.remove_prefix(1);
  unsigned c = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), c, base);
  if (error != std::errc() || end != digits.data() + digits.size() || !is_character(c)) throw XmlError("a number of no character", at);
  return c;
}

}  // namespace

std::size_t first_bad_character(std::string_view text) {
  unsigned character = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t bytes = utf8_length(text.substr(i), character);
    if (bytes == 0 || !is_character(character)) return i;
    i += bytes;
  }
  return std::string_view::npos;
}

std::string in_unix_lines(std::string_view piece) {
  std::string out(piece);
  const auto crlf = [&](std::size_t i) { return i + 1 < piece.size() && piece[i] == '\r' && piece[i + 1] == '\n'; };
  std::size_t size = 0;
  for (std::size_t i = 0; i < piece.size(); ++i) {
    if (!crlf(i)) out[size++] = piece[i] == '\r' ? '\n' : piece[i];
  }
  out.resize(size);
  return out;
}

std::string decoded(const std::string& piece, std::size_t at) {
  if (piece.find('&') == std::string::npos) return piece;
  constexpr std::pair<std::string_view, char> kEntities[] = {{"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"apos", '\''}, {"quot", '"'}};
  std::string out;
  for (std::size_t i = 0; i < piece.size(); ++i) {
    if (piece[i] != '&') {
      out += piece[i];
      continue;
    }
    const std::size_t end = piece.find(';', i);
    if (end == std::string::npos) throw XmlError("'&' without ';'", at);
    const std::string_view word = std::string_view(piece).substr(i + 1, end - i - 1);
    if (word.starts_with('#')) {
      append_utf8(referenced(word.substr(1), at), out);
    } else {
      const auto* const known = std::find_if(std::begin(kEntities), std::end(kEntities), [&](const auto& e) { return e.first == word; });
      if (known == std::end(kEntities)) throw XmlError("an entity", at);
      out += known->second;
    }
    i = end;
  }
  return out;
}

}  // namespace g3r::io
