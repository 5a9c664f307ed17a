// Lines and tokens of text files.
#pragma once

#include "io/random_file.h"
#include "io/source.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace g3r::io {

/// The lines of a text; LF, CR LF and CR all end a line.
class Lines {
 public:
  explicit Lines(std::string_view text, std::size_t lines_before = 0, std::uint64_t bytes_before = 0)
      : text_(text), number_(lines_before), before_(bytes_before) {}
  /// Of a file, from byte `begin` on, of which a piece is in memory. The file must outlive this.
  Lines(const RandomFile& file, std::uint64_t begin, std::size_t lines_before = 0);
  /// The next line without its end; false when there is none. Of a file it is valid until the next call, which throws IoError, and
  /// InvalidInput for a line that is longer than any point is.
  bool next(std::string_view& line);
  /// The next line that is not blank.
  bool next_filled(std::string_view& line);
  /// Number of the line that next() gave last, counted from 1.
  [[nodiscard]] std::size_t number() const { return number_; }
  /// Bytes consumed so far, those before included.
  [[nodiscard]] std::uint64_t offset() const { return before_ + at_; }
  /// Whether the last line given ended with a line end rather than with the text.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  bool find_end();
  bool load();

  std::string_view text_;  // all of it, or the piece in memory
  std::size_t at_ = 0;
  std::size_t number_ = 0;
  std::size_t next_feed_ = 0;  // position of the next LF at or after at_, found once: CR-only files would else cost O(n^2)
  std::size_t length_ = 0;     // of the line at at_, up to its CR or LF
  bool feed_known_ = false;
  bool ended_ = true;
  const RandomFile* file_ = nullptr;
  std::unique_ptr<std::string> piece_;  // of the file; text_ is all of it
  std::uint64_t before_ = 0;            // bytes before text_
};

/// A text that is read from its beginning any number of times: in memory, or in a file of which a piece is in memory.
class Text {
 public:
  /// `source` must outlive this; so must what it refers to.
  explicit Text(const Source& source) : source_(source), size_(source.bytes.size()) {}
  /// `source`: the name for messages. The text begins at byte `begin`.
  Text(const Source& source, const RandomFile& file, std::uint64_t begin)
      : source_(source), file_(&file), begin_(begin), size_(file.size()) {}

  [[nodiscard]] const Source& source() const { return source_; }
  /// Where lines end whose offset() is told.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] Lines lines() const { return lines_from(begin_, 0); }
  /// From a place on that offset() and number() of other lines of this text gave.
  [[nodiscard]] Lines lines_from(std::uint64_t offset, std::size_t lines_before) const;

 private:
  const Source& source_;
  const RandomFile* file_ = nullptr;
  std::uint64_t begin_ = 0;
  std::uint64_t size_;
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

/// The text with small letters for A to Z.
std::string lower_case(std::string_view text);

/// What readers of texts warn of.
inline constexpr const char* kOpenEnd = "the last line has no line end: the file may be cut";

}  // namespace g3r::io
