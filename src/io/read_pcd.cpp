// PCD 0.6 and 0.7: ascii, binary and binary_compressed. Source: pointclouds.org, "The PCD (Point Cloud Data) file format".
#include "io/cloud_from_table.h"
#include "io/lzf.h"
#include "io/readers.h"
#include "io/table.h"
#include "io/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace g3r::io {

namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 20;  // of one point: more is damage

struct PcdHeader {
  Element points = make_vertex_element();
  std::string encoding;  // ascii, binary, binary_compressed
  std::size_t body = 0;
  std::size_t lines = 0;
  std::vector<std::string> kept;  // VIEWPOINT, WIDTH, HEIGHT lines
  std::vector<Vec3> viewpoint;    // position of the sensor, if it is known
};

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

  Type type(std::size_t i) const {
    const std::uint64_t size = sizes_[i];
    switch (types_[i]) {
      case 'F':
        if (size == 4) return Type::kFloat32;
        if (size == 8) return Type::kFloat64;
        break;
      case 'I':
        if (size == 1) return Type::kInt8;
        if (size == 2) return Type::kInt16;
        if (size == 4) return Type::kInt32;
        if (size == 8) return Type::kInt64;
        break;
      case 'U':
        if (size == 1) return Type::kUint8;
        if (size == 2) return Type::kUint16;
        if (size == 4) return Type::kUint32;
        if (size == 8) return Type::kUint64;
        break;
      default:
        fail(source_, "expected TYPE F, I or U for every field, found " + quote(std::string(1, types_[i])));
    }
    fail(source_, "SIZE " + std::to_string(size) + " does not go with TYPE " + std::string(1, types_[i]) + ": expected 1, 2, 4 or 8 bytes");
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

// Commas stand between the values if there are as many fields as values; else they are decimal ones, or wrong.
char separator_of(std::string_view line, std::size_t values) {
  const auto commas = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
  return commas != 0 && commas + 1 == values ? ',' : ' ';
}

void read_ascii(const Source& source, const PcdHeader& header, Element& points, std::vector<std::string>& warnings) {
  std::size_t values = 0;
  for (const Property& field : points.properties) values += field.count;
  const std::string_view body = source.bytes.substr(header.body);
  if (points.count > (body.size() + 1) / (2 * values)) {
    fail_at_byte(source, header.body,
                 "truncated: POINTS " + std::to_string(points.count) + " declared, but only " + std::to_string(body.size()) +
                     " bytes follow (too large)");
  }
  points.data.reserve(bytes_of(points.count, points.stride()));
  Lines lines(body, header.lines);
  std::string_view line;
  bool overflow = false;
  for (std::uint64_t i = 0; i < points.count; ++i) {
    if (!lines.next_filled(line)) {
      fail_at_line(source, lines.number(),
                   "truncated: unexpected end of file after " + std::to_string(i) + " of " + std::to_string(points.count) + " points");
    }
    Tokens tokens(line, separator_of(line, values));
    std::string_view token;
    for (const Property& field : points.properties) {
      for (std::uint32_t k = 0; k < field.count; ++k) {
        if (!tokens.next(token))
          fail_at_line(source, lines.number(), "too few values for point " + std::to_string(i) + (lines.ended() ? "" : " (truncated)"));
        double value = 0;
        if (!parse_double(token, value, &overflow)) fail_at_line(source, lines.number(), expected_number(token));
        char stored[8];
        // A packed colour is written as a whole number under TYPE F by some, as the float it is by others; U and I hold it as it is.
        store_double(field.type, value, stored);
        points.data.append(stored, size_of(field.type));
      }
    }
    if (tokens.next(token)) fail_at_line(source, lines.number(), "more values than FIELDS for point " + std::to_string(i));
  }
  if (!lines.ended() && points.count != 0) warnings.emplace_back("the last line has no line end: the file may be cut");
  if (lines.next_filled(line)) warnings.emplace_back("trailing lines after the last point are not used");
  if (overflow) warnings.emplace_back("a number is out of double's range: it is taken as infinite (not finite)");
}

void read_binary(const Source& source, std::size_t offset, std::string_view body, Element& points, std::vector<std::string>& warnings) {
  const std::size_t stride = points.stride();
  if (points.count > body.size() / stride) {
    fail_at_byte(source, offset,
                 "truncated: POINTS " + std::to_string(points.count) + " of " + std::to_string(stride) + " bytes declared, but only " +
                     std::to_string(body.size()) + " bytes of data follow (too large)");
  }
  points.data.assign(body.substr(0, static_cast<std::size_t>(points.count) * stride));
  if (body.size() > points.data.size())
    warnings.push_back(std::to_string(body.size() - points.data.size()) + " trailing bytes after the last point are not used");
}

// The fields follow each other, all points' values of a field together.
void read_compressed(const Source& source, const PcdHeader& header, Element& points, std::vector<std::string>& warnings) {
  const std::string_view body = source.bytes.substr(header.body);
  if (body.size() < 8) fail_at_byte(source, header.body, "truncated: expected the compressed and uncompressed size (8 bytes)");
  const auto compressed = load<std::uint32_t>(body.data());
  const auto size = load<std::uint32_t>(body.data() + 4);
  if (compressed > body.size() - 8) {
    fail_at_byte(
        source, header.body,
        "truncated: compressed size " + std::to_string(compressed) + ", but only " + std::to_string(body.size() - 8) + " bytes follow");
  }
  const std::string_view stream = body.substr(8, compressed);
  const std::optional<std::size_t> expanded = lzf_size(stream);
  if (!expanded || *expanded != size) {
    fail_at_byte(source, header.body + 8,
                 "corrupt compressed data: expected an uncompressed size of " + std::to_string(size) + " bytes" +
                     (expanded ? ", found " + std::to_string(*expanded) : ", found a damaged stream"));
  }
  const std::size_t stride = points.stride();
  if (size % stride != 0 || size / stride != points.count) {
    fail_at_byte(source, header.body,
                 "the uncompressed size " + std::to_string(size) + " is not that of POINTS " + std::to_string(points.count) + " of " +
                     std::to_string(stride) + " bytes");
  }
  const std::string columns = lzf_expand(stream, size);
  points.data.resize(columns.size());
  const char* from = columns.data();
  std::size_t offset = 0;
  for (const Property& field : points.properties) {
    const std::size_t bytes = size_of(field.type) * field.count;
    for (std::size_t i = 0; i < points.count; ++i, from += bytes) std::copy_n(from, bytes, points.data.data() + i * stride + offset);
    offset += bytes;
  }
  const std::string_view rest = body.substr(8 + std::size_t{compressed});
  if (rest.find_first_not_of('\0') != std::string_view::npos)  // zeros are padding, as PCL writes it
    warnings.emplace_back("trailing bytes after the compressed data are not used");
}

}  // namespace

Cloud read_pcd(const Source& source) {
  PcdHeader header = PcdParser(source).parse();
  Cloud cloud;
  cloud.format = "pcd " + header.encoding;
  cloud.sensor_positions = std::move(header.viewpoint);
  auto table = std::make_shared<Attributes>();
  table->dialect = Attributes::Dialect::kPcd;
  table->elements.push_back(std::move(header.points));
  Element& points = table->elements.back();
  if (header.encoding == "ascii") {
    read_ascii(source, header, points, cloud.warnings);
  } else if (header.encoding == "binary") {
    read_binary(source, header.body, source.bytes.substr(header.body), points, cloud.warnings);
  } else {
    read_compressed(source, header, points, cloud.warnings);
  }
  table->comments = std::move(header.kept);
  fill_cloud(source, std::move(table), cloud);
  return cloud;
}

std::optional<StoredTable> find_pcd_records(const Source& head, std::uint64_t file_size) {
  if (head.bytes.find("\nDATA binary\n") == std::string_view::npos) return std::nullopt;  // a line of its own, and not in a comment
  PcdHeader header = PcdParser(head).parse();
  const std::size_t stride = header.points.stride();
  if (header.encoding != "binary" || header.points.count > (file_size - header.body) / stride) return std::nullopt;
  StoredTable stored;
  stored.begin = header.body;
  stored.table.dialect = Attributes::Dialect::kPcd;
  stored.table.comments = std::move(header.kept);
  stored.table.elements.push_back(std::move(header.points));
  return stored;
}

}  // namespace g3r::io
