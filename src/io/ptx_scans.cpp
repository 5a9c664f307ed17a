#include "io/ptx_scans.h"

#include "io/text_numbers.h"

#include <cmath>
#include <string>
#include <string_view>
#include <utility>

namespace g3r::io {

namespace {

constexpr std::uint64_t kLeastLine = 6;  // bytes of "0 0 0" and its end

class Finder {
 public:
  explicit Finder(const Text& text) : text_(text), source_(text.source()), lines_(text.lines()) {}

  PtxScans find() {
    std::string_view line;
    while (lines_.next_filled(line)) find_scan(line);
    found_.open_end = !lines_.ended();
    return std::move(found_);
  }

 private:
  // Reads a header, of which `line` is the first line, and passes over the points.
  void find_scan(std::string_view line) {
    const std::string what =
        found_.scans.empty() ? "columns of a scan" : "columns of the next scan (more points follow than the last one declares?)";
    const std::uint64_t columns = parse_count(source_, lines_.number(), line, what);
    line = header_line();
    const std::uint64_t rows = parse_count(source_, lines_.number(), line, "rows of a scan");
    const std::uint64_t left = (text_.size() - lines_.offset() + 1) / kLeastLine;  // the last line may lack its end
    if (rows != 0 && columns > left / rows) {
      fail_at_line(source_, lines_.number(),
                   "truncated: " + std::to_string(columns) + " columns of " + std::to_string(rows) + " points declared, but only " +
                       std::to_string(text_.size() - lines_.offset()) + " bytes follow (count too large)");
    }
    for (int skipped = 0; skipped < 4; ++skipped) header_numbers<3>();  // the matrix says all of the position and the axes
    PtxScan scan;
    scan.count = columns * rows;
    for (std::size_t row = 0; row < 4; ++row) {
      const std::array<double, 4> numbers = header_numbers<4>();
      if (numbers[3] != (row == 3 ? 1 : 0))
        fail_at_line(source_, lines_.number(), "expected a matrix whose last column is 0 0 0 1 (the shift is its last row)");
      (row == 3 ? scan.origin : scan.axes[row]) = {numbers[0], numbers[1], numbers[2]};
    }
    scan.offset = lines_.offset();
    scan.lines = lines_.number();
    for (std::uint64_t i = 0; i < scan.count; ++i) {
      if (!lines_.next_filled(line)) {
        fail_at_line(source_, lines_.number(),
                     "truncated: unexpected end of file after " + std::to_string(i) + " of " + std::to_string(scan.count) +
                         " points of scan " + std::to_string(found_.scans.size() + 1));
      }
      if (i == 0) scan.columns = count(line);
      scan.hits += is_hit(line) ? 1 : 0;
    }
    if (scan.columns != 0) found_.scans.push_back(scan);
  }

  // Whether its first three numbers are not all 0. What are no numbers is told when the point is read.
  static bool is_hit(std::string_view line) {
    Tokens tokens(line);
    std::string_view token;
    for (int a = 0; a < 3 && tokens.next(token); ++a) {
      double value = 0;
      if (!parse_double(token, value) || value != 0) return true;
    }
    return false;
  }

  static std::size_t count(std::string_view line) {
    Tokens tokens(line);
    std::string_view token;
    std::size_t found = 0;
    while (tokens.next(token)) ++found;
    return found;
  }

  std::string_view header_line() {
    std::string_view line;
    if (!lines_.next_filled(line)) fail_at_line(source_, lines_.number(), "truncated: the header of a scan has ten lines");
    return line;
  }

  template <std::size_t N>
  std::array<double, N> header_numbers() {
    std::array<double, N> numbers{};
    Tokens tokens(header_line());
    std::string_view token;
    std::size_t found = 0;
    while (tokens.next(token)) {
      double value = 0;
      if (!parse_double(token, value)) fail_at_line(source_, lines_.number(), expected_number(token));
      if (!std::isfinite(value)) fail_at_line(source_, lines_.number(), "the pose of a scan is not finite");
      if (found < N) numbers[found] = value;
      ++found;
    }
    if (found != N) {
      fail_at_line(
          source_, lines_.number(),
          "expected " + std::to_string(N) + " numbers in this line of a scan's header (a count is wrong?), found " + std::to_string(found));
    }
    return numbers;
  }

  const Text& text_;
  const Source& source_;
  Lines lines_;
  PtxScans found_;
};

}  // namespace

PtxScans find_ptx_scans(const Text& text) { return Finder(text).find(); }

}  // namespace g3r::io
