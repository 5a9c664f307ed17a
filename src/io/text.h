// Lines, tokens and numbers of text files. Numbers go through from_chars and to_chars (io/float_text.h) only, so the
// locale never matters.
#pragma once

#include "io/source.h"

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

namespace g3r::io {

/// The lines of a text; LF, CR LF and CR all end a line.
class Lines {
 public:
  explicit Lines(std::string_view text, std::size_t lines_before = 0) : text_(text), number_(lines_before) {}
  /// The next line without its end; false when there is none.
  bool next(std::string_view& line);
  /// The next line that is not blank.
  bool next_filled(std::string_view& line);
  /// Number of the line that next() gave last, counted from 1.
  [[nodiscard]] std::size_t number() const { return number_; }
  /// Bytes consumed so far.
  [[nodiscard]] std::size_t offset() const { return at_; }
  /// Whether the last line given ended with a line end rather than with the text.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
  std::size_t next_feed_ = 0;  // position of the next LF at or after at_, found once: CR-only files would else cost O(n^2)
  bool feed_known_ = false;
  bool ended_ = true;
};

/// The tokens of a line, separated by blanks, or by one given character (then tokens may be empty and are trimmed).
class Tokens {
 public:
  explicit Tokens(std::string_view line, char separator = ' ') : rest_(line), separator_(separator), more_(separator != ' ') {}
  bool next(std::string_view& token);

 private:
  std::string_view rest_;
  char separator_;
  bool more_;
};

/// The text without blanks at both ends.
std::string_view trim(std::string_view text);

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

/// `number` words, for messages: "expected a number, found "0,5" (a decimal comma? use a point)".
std::string expected_number(std::string_view found);

/// The shortest text that reads back as the same number.
void append_number(std::string& text, double value);
void append_number(std::string& text, float value);
void append_number(std::string& text, std::int64_t value);
void append_number(std::string& text, std::uint64_t value);

}  // namespace g3r::io
