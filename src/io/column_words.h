// The values of a text's columns that are no numbers: words, and cells without a value.
#pragma once

#include "io/column_facts.h"
#include "io/point_rows.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

class ColumnWords {
 public:
  /// Both must outlive this.
  ColumnWords(const Source& source, const TextShape& shape) : source_(source), shape_(shape), words_(shape.columns) {}
  /// Takes note of a word, as PointRows tells it.
  void note(std::size_t column, std::size_t line, std::string_view value);
  /// After the last point: what PointRows::missing() says. The rest can be asked from then on.
  void set_missing(const std::vector<PointRows::Missing>& missing) { missing_ = missing; }

  /// Which columns hold text. Throws InvalidInput where a column of numbers has a word here and there.
  [[nodiscard]] std::vector<TextColumn> find_text() const;
  /// Whether a column has numbers and no words. One that is no coordinate is of no use otherwise.
  [[nodiscard]] bool is_used(std::size_t column) const { return words_[column].count == 0 && missing_[column].count < shape_.points; }
  /// Throws InvalidInput where a column, which is one of coordinates, has words or no number at all.
  void require_numbers(std::size_t column) const;
  /// The beginning of the first word of a column, "" if it has none.
  [[nodiscard]] const std::string& first(std::size_t column) const { return words_[column].first; }
  /// A line for each column of numbers with missing values.
  [[nodiscard]] std::vector<std::string> about_missing() const;

 private:
  [[noreturn]] void fail_at_word(std::size_t column) const;

  struct Words {
    std::uint64_t count = 0;
    std::size_t line = 0;  // of the first
    std::string first;
    bool like_numbers = false;  // some begin like a number
  };
  const Source& source_;
  const TextShape& shape_;
  std::vector<Words> words_;
  std::vector<PointRows::Missing> missing_;
};

}  // namespace g3r::io
