#include "io/column_words.h"

#include "io/text_numbers.h"
#include "io/text_values.h"

namespace g3r::io {

namespace {

// A column with a word in more than one line of so many holds text; fewer words are damage, which is an error.
constexpr std::uint64_t kLinesPerWord = 100;

constexpr std::size_t kKeptWord = 256;  // bytes of a word that are kept for messages, which show fewer

}  // namespace

void ColumnWords::note(std::size_t column, std::size_t line, std::string_view value) {
  Words& here = words_[column];
  if (here.count++ == 0) {
    here.line = line;
    here.first = value.substr(0, kKeptWord);
  }
  here.like_numbers = here.like_numbers || is_like_number(value);
}

void ColumnWords::fail_at_word(std::size_t column) const {
  fail_at_line(source_, words_[column].line, expected_number(words_[column].first, " in " + column_text(shape_, column)));
}

std::vector<TextColumn> ColumnWords::find_text() const {
  std::vector<TextColumn> text(words_.size());
  std::size_t damage = words_.size();
  for (std::size_t c = 0; c < words_.size(); ++c) {
    const Words& words = words_[c];
    text[c].any = words.count != 0;
    text[c].all = text[c].any && words.count + missing_[c].count == shape_.points && !words.like_numbers;
    if (text[c].any && words.count * kLinesPerWord <= shape_.points && (damage == words_.size() || words.line < words_[damage].line)) {
      damage = c;
    }
  }
  if (damage < words_.size()) fail_at_word(damage);
  return text;
}

void ColumnWords::require_numbers(std::size_t column) const {
  if (words_[column].count != 0) fail_at_word(column);
  if (missing_[column].count == shape_.points) {
    fail_at_line(source_, missing_[column].line,
                 "expected a coordinate in " + column_text(shape_, column) + ", found no number in any line");
  }
}

std::vector<std::string> ColumnWords::about_missing() const {
  std::vector<PointRows::Missing> missing = missing_;
  for (std::size_t c = 0; c < missing.size(); ++c) {
    if (words_[c].count != 0) missing[c].count = 0;
  }
  return io::about_missing(shape_, missing);
}

}  // namespace g3r::io
