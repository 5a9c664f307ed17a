#include "io/grid_header.h"

#include "io/text_numbers.h"

#include <cmath>
#include <optional>

namespace g3r::io {

namespace {

constexpr std::uint64_t kLeastValue = 2;  // bytes of a digit and the blank after it
constexpr std::size_t kLongestKey = 16;   // bytes, more than any has
constexpr int kMostKeys = 7;              // lines of a header

// What the keys stand for.
enum GridField : std::size_t { kColumns, kRows, kX, kY, kWidth, kNeeded, kHeight = kNeeded, kNoData, kGridFields };

constexpr std::array<const char*, kNeeded> kKeysOf = {"ncols", "nrows", "xllcorner or xllcenter", "yllcorner or yllcenter",
                                                      "cellsize or dx"};

struct GridKey {
  std::string_view name;
  GridField field;
};
constexpr std::array<GridKey, 11> kGridKeys = {{{"ncols", kColumns},
                                                {"nrows", kRows},
                                                {"xllcorner", kX},
                                                {"xllcenter", kX},
                                                {"yllcorner", kY},
                                                {"yllcenter", kY},
                                                {"cellsize", kWidth},
                                                {"dx", kWidth},
                                                {"dy", kHeight},
                                                {"nodata_value", kNoData},
                                                {"nodata", kNoData}}};

// Null for what is no key.
const GridKey* find_grid_key(std::string_view word) {
  const std::string name = lower_case(word.substr(0, kLongestKey));
  for (const GridKey& key : kGridKeys) {
    if (key.name == name) return &key;
  }
  return nullptr;
}

class GridHeaderLines {
 public:
  explicit GridHeaderLines(const Text& text) : source_(text.source()), lines_(text.lines()), size_(text.size()) {}

  GridHeader read() {
    std::string_view word;
    for (double value = 0;;) {
      header_.offset = lines_.offset();
      header_.lines = lines_.number();
      std::string_view line;
      if (!lines_.next_filled(line)) fail_here("truncated: no values follow the header of the grid");
      Tokens tokens(line);
      tokens.next(word);
      if (parse_double(word, value)) break;
      take(word, tokens);
    }
    for (std::size_t field = 0; field < kNeeded; ++field) {
      if (!values_[field]) fail_here(std::string("expected ") + kKeysOf[field] + " in the header of the grid, found values without it");
    }
    header_.corner = {*values_[kX], *values_[kY]};
    header_.size = {*values_[kWidth], values_[kHeight].value_or(*values_[kWidth])};
    header_.no_data = values_[kNoData].value_or(kUsualNoData);
    check_counts();
    return header_;
  }

 private:
  [[noreturn]] void fail_here(const std::string& what) const { fail_at_line(source_, lines_.number(), what); }

  void take(std::string_view word, Tokens& tokens) {
    const GridKey* key = find_grid_key(word);
    if (key == nullptr) {
      fail_here("expected a key of the grid's header (ncols, nrows, xllcorner, yllcorner, cellsize, NODATA_value) or a value, found " +
                quote(word));
    }
    const std::string name(key->name);
    if (values_[key->field]) fail_here("expected each key once in the header of the grid, found " + name + " after another of its kind");
    std::string_view token;
    std::string_view more;
    tokens.next(token);
    if (tokens.next(more)) fail_here("expected one number after " + name + ", found more: " + quote(more));
    values_[key->field] = key->field <= kRows ? count(*key, token) : number(*key, token);
    if (name.ends_with("corner")) header_.to_middle[key->field - kX] = 0.5;
  }

  double count(const GridKey& key, std::string_view token) {
    const std::uint64_t count =
        parse_count(source_, lines_.number(), token, key.field == kColumns ? "columns of the grid (ncols)" : "rows of the grid (nrows)");
    if (count == 0) fail_here("expected " + std::string(key.name) + " of at least 1, found 0");
    (key.field == kColumns ? header_.columns : header_.rows) = count;
    return 1;
  }

  [[nodiscard]] double number(const GridKey& key, std::string_view token) const {
    double value = 0;
    if (!parse_double(token, value)) fail_here(expected_number(token, " after " + std::string(key.name)));
    if (key.field != kNoData && !std::isfinite(value)) fail_here("expected a finite " + std::string(key.name) + ", found " + quote(token));
    if ((key.field == kWidth || key.field == kHeight) && value <= 0)
      fail_here("expected a " + std::string(key.name) + " above 0, found " + quote(token));
    return value;
  }

  void check_counts() const {
    const std::uint64_t left = size_ - header_.offset;
    if (header_.columns <= (left + 1) / kLeastValue / header_.rows) return;  // the last value may lack its blank
    fail_here("truncated: " + header_.counts() + " declared, but only " + std::to_string(left) +
              " bytes follow the header (count too large)");
  }

  const Source& source_;
  Lines lines_;
  std::uint64_t size_;
  GridHeader header_;
  std::array<std::optional<double>, kGridFields> values_{};  // of counts, that they are there
};

}  // namespace

std::string GridHeader::counts() const { return std::to_string(columns) + " x " + std::to_string(rows) + " values (ncols x nrows)"; }

GridHeader read_grid_header(const Text& text) { return GridHeaderLines(text).read(); }

bool is_ascii_grid(std::string_view bytes) {
  Lines lines(bytes);
  std::string_view line;
  int keys = 0;
  for (int k = 0; k < kMostKeys && lines.next_filled(line); ++k) {
    Tokens tokens(line);
    std::string_view word;
    double value = 0;
    tokens.next(word);
    if (parse_double(word, value)) break;
    const GridKey* key = find_grid_key(word);
    const bool pair = tokens.next(word) && !tokens.next(word);
    if (key != nullptr && key->name.size() > 2 && pair) ++keys;  // dx and dy may be names of columns
  }
  return keys >= 2;
}

}  // namespace g3r::io
