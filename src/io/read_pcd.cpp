// PCD 0.6 and 0.7: ascii, binary and binary_compressed.
#include "io/cloud_from_table.h"
#include "io/lzf.h"
#include "io/pcd_header.h"
#include "io/readers.h"
#include "io/table.h"
#include "io/text.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <optional>

namespace g3r::io {

namespace {

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
        // A packed colour is written as a whole number under TYPE F by some, as the float it is by others; U and I hold it as it is.
        append_double(field.type, value, points.data);
      }
    }
    if (tokens.next(token)) fail_at_line(source, lines.number(), "more values than FIELDS for point " + std::to_string(i));
  }
  if (!lines.ended() && points.count != 0) warnings.emplace_back(kOpenEnd);
  if (lines.next_filled(line)) warnings.emplace_back("trailing lines after the last point are not used");
  if (overflow) warnings.emplace_back(kOverflow);
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
  PcdHeader header = read_pcd_header(source);
  Cloud cloud;
  cloud.format = "pcd " + header.encoding;
  cloud.sensor_positions = std::move(header.viewpoint);
  const std::shared_ptr<Attributes> table = Attributes::of_points(Attributes::Dialect::kPcd, std::move(header.points));
  Element& points = table->elements.back();
  if (header.encoding == "ascii") {
    read_ascii(source, header, points, cloud.warnings);
  } else if (header.encoding == "binary") {
    read_binary(source, header.body, source.bytes.substr(header.body), points, cloud.warnings);
  } else {
    read_compressed(source, header, points, cloud.warnings);
  }
  table->comments = std::move(header.kept);
  fill_cloud(source, table, cloud);
  return cloud;
}

std::optional<StoredTable> find_pcd_records(const Source& head, std::uint64_t file_size) {
  if (head.bytes.find("\nDATA binary\n") == std::string_view::npos) return std::nullopt;  // a line of its own, and not in a comment
  PcdHeader header = read_pcd_header(head);
  if (header.encoding != "binary") return std::nullopt;
  return stored_table(Attributes::Dialect::kPcd, std::move(header.kept), std::move(header.points), header.body, file_size);
}

}  // namespace g3r::io
