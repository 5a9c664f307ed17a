#include "io/pcd_header.h"

#include "io/text.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace g3r::io {

namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 20;  // of one point: more is damage

class PcdParser {
 public:
  explicit PcdParser(const Source& source) : source_(source), lines_(source.bytes) {}

  PcdHeader parse() {
    std::string_view line;
    while (header_.encoding.empty() && lines_.next_filled(line)) {
      if (line[0] == '#') {
        if (line.substr(0, 6) != "# .PCD") header_.kept.emplace_back(line);
        continue;
      }
      Tokens words(line);
      std::string_view keyword;
      words.next(keyword);
      statement(keyword, words, line);
    }
    if (header_.encoding.empty()) fail(source_, "the header does not end: expected a line DATA ascii, binary or binary_compressed");
    header_.body = static_cast<std::size_t>(lines_.offset());
    header_.lines = lines_.number();
    finish();
    return std::move(header_);
  }

 private:
  void statement(std::string_view keyword, Tokens& words, std::string_view line) {
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      if (!header_.points.properties.empty()) fail_here("a second FIELDS line");
      std::size_t count = 0;
      std::string_view word;
      for (Tokens counting = words; counting.next(word);) ++count;
      header_.points.properties.resize(count);
      for (Property& property : header_.points.properties) {
        words.next(word);
        property.name = std::string(word);
      }
    } else if (keyword == "SIZE") {
      sizes_ = integers(words, "SIZE of a field");
    } else if (keyword == "COUNT") {
      counts_ = integers(words, "COUNT of a field");
    } else if (keyword == "TYPE") {
      std::string_view word;
      while (words.next(word)) types_ += word.size() == 1 ? word[0] : '?';
    } else if (keyword == "WIDTH") {
      width_ = only(words, "WIDTH (points in a row)");
      if (width_ != 0) header_.kept.emplace_back(line);
    } else if (keyword == "HEIGHT") {
      height_ = only(words, "HEIGHT (rows)");
      header_.kept.emplace_back(line);
    } else if (keyword == "POINTS") {
      points_ = only(words, "POINTS");
    } else if (keyword == "VIEWPOINT") {
      header_.kept.emplace_back(line);
      find_viewpoint(words);
    } else if (keyword == "DATA") {
      std::string_view word;
      words.next(word);
      if (word != "ascii" && word != "binary" && word != "binary_compressed") {
        fail_here("expected DATA ascii, binary or binary_compressed, found " + quote(word));
      }
      header_.encoding = std::string(word);
    } else if (keyword != "VERSION") {
      fail_here("unknown keyword " + quote(keyword) + " in the PCD header");
    }
  }

  // Position and rotation (w x y z). The identity is written by those who do not know; what is no pose is kept as text alone.
  void find_viewpoint(Tokens& words) {
    constexpr std::array<double, 7> kUnknown = {0, 0, 0, 1, 0, 0, 0};
    std::array<double, 7> pose{};
    std::string_view word;
    for (double& value : pose) {
      if (!words.next(word) || !parse_double(word, value) || !std::isfinite(value)) return;
    }
    if (pose != kUnknown) header_.viewpoint.assign(1, {pose[0], pose[1], pose[2]});
  }

  std::vector<std::uint64_t> integers(Tokens& words, const char* what) {
    std::vector<std::uint64_t> values;
    std::string_view word;
    while (words.next(word)) values.push_back(parse_count(source_, lines_.number(), word, what));
    return values;
  }

  std::uint64_t only(Tokens& words, const char* what) {
    std::string_view word;
    words.next(word);
    return parse_count(source_, lines_.number(), word, what);
  }

  void finish() {
    std::vector<Property>& fields = header_.points.properties;
    if (fields.empty()) fail(source_, "no FIELDS line in the header");
    if (counts_.empty()) counts_.assign(fields.size(), 1);
    require(sizes_.size() == fields.size(), "SIZE");
    require(types_.size() == fields.size(), "TYPE");
    require(counts_.size() == fields.size(), "COUNT");
    std::uint64_t bytes = 0;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      fields[i].type = type(i);
      if (counts_[i] == 0 || counts_[i] > kMostBytes)
        fail(source_, "COUNT " + std::to_string(counts_[i]) + " for field " + quote(fields[i].name) + " (too small or large)");
      fields[i].count = static_cast<std::uint32_t>(counts_[i]);
      bytes += counts_[i] * sizes_[i];
      if (bytes > kMostBytes) fail(source_, "the COUNT and SIZE of the fields add up to more than 1 MiB for a point");
    }
    check_names();
    if (height_ != 0 && width_ > std::numeric_limits<std::uint64_t>::max() / height_) fail(source_, "WIDTH times HEIGHT is too large");
    const std::uint64_t organised = width_ * height_;
    if (points_ && width_given() && organised != *points_) {
      fail(source_, "WIDTH times HEIGHT (" + std::to_string(organised) + ") and POINTS (" + std::to_string(*points_) + ") differ");
    }
    header_.points.count = points_.value_or(organised);
  }

  [[nodiscard]] bool width_given() const { return width_ != 0 || height_ != 1; }

  void require(bool same, const char* keyword) const {
    if (!same) fail(source_, std::string("the header has not one ") + keyword + " for each of the FIELDS");
  }

  [[nodiscard]] Type type(std::size_t i) const {
    const std::uint64_t size = sizes_[i];
    const char letter = types_[i];
    if (letter != 'F' && letter != 'I' && letter != 'U')
      fail(source_, "expected TYPE F, I or U for every field, found " + quote(std::string(1, letter)));
    const std::optional<Type> type = type_of(letter == 'F'   ? NumberKind::kFloat
                                             : letter == 'I' ? NumberKind::kSigned
                                                             : NumberKind::kUnsigned,
                                             size);
    if (!type)
      fail(source_, "SIZE " + std::to_string(size) + " does not go with TYPE " + std::string(1, letter) + ": expected 1, 2, 4 or 8 bytes");
    return *type;
  }

  void check_names() const {
    std::vector<std::string_view> names;
    names.reserve(header_.points.properties.size());
    for (const Property& field : header_.points.properties) {
      if (field.name != "_") names.push_back(field.name);  // padding
    }
    std::sort(names.begin(), names.end());
    const auto twin = std::adjacent_find(names.begin(), names.end());
    if (twin != names.end()) fail(source_, "the field " + quote(*twin) + " is declared twice (duplicate)");
  }

  [[noreturn]] void fail_here(const std::string& what) const { fail_at_line(source_, lines_.number(), what); }

  const Source& source_;
  Lines lines_;
  PcdHeader header_;
  std::vector<std::uint64_t> sizes_;
  std::vector<std::uint64_t> counts_;
  std::string types_;
  std::uint64_t width_ = 0;
  std::uint64_t height_ = 1;
  std::optional<std::uint64_t> points_;
};

}  // namespace

PcdHeader read_pcd_header(const Source& source) { return PcdParser(source).parse(); }

}  // namespace g3r::io
