// The numbers of a text with one point per line.
#pragma once

#include "io/point_lines.h"
#include "io/text_shape.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

/// The numbers of the points.
class PointRows {
 public:
  /// Is told of words (column, line, value), which become NaN as missing values do; throws where there must be numbers.
  using Word = std::function<void(std::size_t, std::size_t, std::string_view)>;
  PointRows(const Text& text, const TextShape& shape, Word word);
  /// The columns of the next point, null at the end; valid until the next call. Throws InvalidInput where a line has more or fewer.
  const double* next();
  /// Whether a number was beyond double's range.
  [[nodiscard]] bool overflow() const { return overflow_; }

  /// Values that were not there (is_missing()), which become NaN.
  struct Missing {
    std::uint64_t count = 0;
    std::size_t line = 0;  ///< of the first
  };
  [[nodiscard]] const std::vector<Missing>& missing() const { return missing_; }

 private:
  void take(std::size_t column, std::string_view value);

  const Source* source_;
  PointLines lines_;
  Word word_;
  char separator_;
  std::vector<double> row_;
  std::vector<Missing> missing_;
  bool overflow_ = false;
};

/// A line for each column with missing values.
std::vector<std::string> about_missing(const TextShape& shape, const std::vector<PointRows::Missing>& missing);

/// What to do with words in columns of numbers: an error.
PointRows::Word no_words(const Text& text, const TextShape& shape);

}  // namespace g3r::io
