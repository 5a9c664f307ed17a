// The lines of a text with one point per line that hold points. Others are comments, which start with # or //, lines of words before the
// points, and the counts of PTS files.
#pragma once

#include "io/text.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace g3r::io {

/// Whether a line, which is not blank, is a comment. CloudCompare's "//X Y Z" is one that names columns.
bool is_comment(std::string_view line);

/// Whether a line is one of words that may stand before the points: it starts with a word and is no point whose first column holds text.
bool is_header(std::string_view line);

/// The lines that hold points, in one pass.
class PointLines {
 public:
  explicit PointLines(const Text& text) : source_(&text.source()), lines_(text.lines()) {}
  /// The next one; false at the end. Throws InvalidInput where fewer lines follow than a count line says.
  bool next(std::string_view& line);
  /// Of the line that next() gave last.
  [[nodiscard]] std::size_t number() const { return lines_.number(); }
  /// Whether there was a count line.
  [[nodiscard]] bool counted() const { return counted_; }
  /// What the first count line says that more points follow than it says.
  [[nodiscard]] std::optional<std::uint64_t> announced() const { return announced_; }
  /// Whether the last line has no line end.
  [[nodiscard]] bool open_end() const { return open_end_; }

 private:
  void check_block();

  const Source* source_;
  Lines lines_;
  bool first_ = true;
  bool counted_ = false;
  bool open_end_ = false;
  std::uint64_t block_ = 0;  // points that the last count line announced
  std::uint64_t seen_ = 0;
  std::optional<std::uint64_t> announced_;
  int headers_ = 0;  // lines of words before the points
};

}  // namespace g3r::io
