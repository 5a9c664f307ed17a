#include "io/text.h"

#include <algorithm>

namespace g3r::io {

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18;         // bytes of a file read at once; larger gains no time
constexpr std::size_t kLongestLine = std::size_t{16} << 20;  // bytes: the longest line is in memory; 1000 columns take a thousandth

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r'; }

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

}  // namespace g3r::io
