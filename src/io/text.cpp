#include "io/text.h"

#include "io/float_text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace g3r::io {

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18;         // bytes of a file read at once; larger gains no time
constexpr std::size_t kLongestLine = std::size_t{16} << 20;  // bytes: the longest line is in memory; 1000 columns take a thousandth

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r'; }

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

Lines::Lines(const RandomFile& file, std::uint64_t begin, std::size_t lines_before)
    : number_(lines_before), file_(&file), piece_(std::make_unique<std::string>()), before_(begin) {}

// Whether it is known where the line at at_ ends, of the text in memory; a CR at its end may be one of a CR LF.
bool Lines::find_end() {
  if (!feed_known_ || next_feed_ < at_) {
    next_feed_ = std::min(text_.find('\n', at_), text_.size());
    feed_known_ = true;
  }
  const std::string_view upto_feed = text_.substr(at_, next_feed_ - at_);
  length_ = std::min(upto_feed.find('\r'), upto_feed.size());
  return next_feed_ < text_.size() || at_ + length_ + 1 < text_.size();
}

// The next bytes of the file behind those that are not consumed; false if there are none.
bool Lines::load() {
  if (file_ == nullptr || before_ + text_.size() >= file_->size()) return false;
  if (text_.size() - at_ > kLongestLine) {
    throw InvalidInput(escape_text(file_->path()) + ": line " + std::to_string(number_ + 1) + ": more than " +
                       std::to_string(kLongestLine >> 20U) + " MiB without a line end: expected one point per line");
  }
  before_ += at_;
  piece_->erase(0, at_);
  at_ = 0;
  feed_known_ = false;
  const std::size_t known = piece_->size();
  piece_->resize(known + static_cast<std::size_t>(std::min<std::uint64_t>(kPiece, file_->size() - before_ - known)));
  file_->read(before_ + known, piece_->data() + known, piece_->size() - known);
  text_ = *piece_;
  return true;
}

bool Lines::next(std::string_view& line) {
  if (at_ >= text_.size() && !load()) return false;
  while (!find_end() && load()) {
  }
  line = text_.substr(at_, length_);
  at_ += length_;
  ++number_;
  ended_ = at_ < text_.size();
  if (!ended_) return true;
  const bool carriage = text_[at_++] == '\r';
  if (carriage && at_ < text_.size() && text_[at_] == '\n') ++at_;
  return true;
}

Lines Text::lines_from(std::uint64_t offset, std::size_t lines_before) const {
  if (file_ != nullptr) return {*file_, offset, lines_before};
  return Lines(source_.bytes.substr(static_cast<std::size_t>(offset)), lines_before, offset);
}

bool Lines::next_filled(std::string_view& line) {
  while (next(line)) {
    line = trim(line);
    if (!line.empty()) return true;
  }
  return false;
}

bool Tokens::next(std::string_view& token) {
  if (separator_ != ' ') {
    if (!more_) return false;
    const std::size_t end = rest_.find(separator_);
    token = trim(rest_.substr(0, end));
    more_ = end != std::string_view::npos;
    if (more_) rest_.remove_prefix(end + 1);
    return true;
  }
  std::size_t begin = 0;
  while (begin < rest_.size() && is_blank(rest_[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest_.size() && !is_blank(rest_[end])) ++end;
  token = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return !token.empty();
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

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

}  // namespace g3r::io
