// NPY: N x 3 or more, floats or integers, either byte order, row or column major; or structured with x, y, z.
#include "io/cloud_from_table.h"
#include "io/column_facts.h"
#include "io/npy_header.h"
#include "io/readers.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace g3r::io {

namespace {

// IEEE 754 binary16 from its bits, as a float.
float half_to_float(std::uint32_t bits) {
  const std::uint32_t sign = (bits & 0x8000U) << 16;
  const std::uint32_t exponent = bits >> 10 & 31U;
  const std::uint32_t fraction = bits & 1023U;
  if (exponent == 31) return bits_as<float>(sign | 0x7F800000U | fraction << 13);
  if (exponent == 0) return (sign != 0 ? -1.0F : 1.0F) * static_cast<float>(fraction) * 0x1p-24F;
  return bits_as<float>(sign | (exponent + 112) << 23 | fraction << 13);
}

// What columns 4 to 6 of rows are named after, which takes their values.
class FourthToSixth {
 public:
  explicit FourthToSixth(const Element& points) : type_(points.properties[0].type), stride_(points.stride()) {}
  static bool exist(const Element& points) { return points.properties.size() >= kEnd; }

  // Takes note of rows; says whether more of them can tell more.
  bool add(const char* rows, std::size_t count) {
    for (std::size_t i = 0; i < count && may_be_colors_; ++i, rows += stride_) {
      double values[3];
      for (std::size_t c = 0; c < 3; ++c) values[c] = load_as_double(type_, rows + (kFirst + c) * size_of(type_));
      facts_.add(values);
      may_be_colors_ = facts_.are_whole(0) && facts_.are_whole(1) && facts_.are_whole(2);
    }
    return may_be_colors_;
  }

  void name(std::vector<Property>& properties) const {
    if (facts_.are_counts(0) && !facts_.are_deep_colors(0)) return;
    constexpr const char* kNames[2][3] = {{"nx", "ny", "nz"}, {"red", "green", "blue"}};
    for (std::size_t c = 0; c < 3; ++c) properties[kFirst + c].name = kNames[facts_.are_deep_colors(0) ? 1 : 0][c];
  }

 private:
  static constexpr std::size_t kFirst = 3;
  static constexpr std::size_t kEnd = 6;
  Type type_;
  std::size_t stride_;
  ColumnFacts facts_{3};
  bool may_be_colors_ = true;
};

// By number: x y z, then what FourthToSixth names, then scalars.
void name_columns(std::vector<Property>& properties) {
  constexpr const char* kNames[] = {"x", "y", "z"};
  for (std::size_t c = 0; c < properties.size(); ++c) {
    properties[c].name = c < 3 ? std::string(kNames[c]) : std::string("scalar_") += std::to_string(c + 1);
  }
}

// The rows as one element without data.
Element describe_points(const Source& source, const NpyHeader& header) {
  if (header.fields.empty()) fail(source, "an empty dtype in the header");
  Element points = make_vertex_element();
  points.properties = header.fields;
  if (header.is_structured()) {
    if (header.shape.size() != 1)
      fail(source, "expected one dimension in the shape of a structured array, found " + std::to_string(header.shape.size()));
  } else {
    if (header.shape.size() != 2)
      fail(source, "expected the shape (N, 3) with two dimensions, found " + std::to_string(header.shape.size()) + " dimensions");
    constexpr std::uint64_t kMostColumns = 1000;  // Wider arrays are no points.
    constexpr std::uint64_t kWide = 16;           // Three rows of more columns than this are three coordinates of as many points.
    const std::uint64_t columns = header.shape[1];
    if (columns < 3 || columns > kMostColumns || (header.shape[0] == 3 && columns > kWide)) {
      fail(source, "expected the shape (N, 3) with 3 to 1000 columns, found " + std::to_string(columns) + " columns" +
                       (header.shape[0] == 3 ? " and 3 rows (a transposed array?)" : ""));
    }
    points.properties.assign(static_cast<std::size_t>(columns), header.fields[0]);
    name_columns(points.properties);
  }
  points.count = header.shape[0];
  return points;
}

// The values of plain columns that lie one after the other, row by row.
std::string rows_of_columns(const char* from, std::size_t rows, const std::vector<Property>& columns) {
  const std::size_t bytes = size_of(columns[0].type);
  const std::size_t stride = columns.size() * bytes;
  std::string records(rows * stride, '\0');
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::size_t i = 0; i < rows; ++i, from += bytes) std::memcpy(records.data() + i * stride + c * bytes, from, bytes);
  }
  return records;
}

// Without the fields that are padding.
void drop_padding(Element& points) {
  const std::vector<Property> fields = points.properties;
  const std::string rows = std::move(points.data);
  points.data.clear();
  const char* from = rows.data();
  for (std::uint64_t i = 0; i < points.count; ++i) {
    for (const Property& field : fields) {
      const std::size_t bytes = size_of(field.type) * field.count;
      if (!field.name.empty()) points.data.append(from, bytes);
      from += bytes;
    }
  }
  std::erase_if(points.properties, [](const Property& field) { return field.name.empty(); });
}

// With their data; float16 becomes float32.
Element make_points(const Source& source, const NpyHeader& header, std::vector<std::string>& warnings) {
  Element points = describe_points(source, header);
  const std::uint64_t rows = points.count;
  const std::size_t stride = points.stride();
  const std::string_view body = source.bytes.substr(header.body);
  if (rows > body.size() / stride) {
    fail_at_byte(source, header.body,
                 "truncated: the shape needs " + std::to_string(rows) + " rows of " + std::to_string(stride) + " bytes, but only " +
                     std::to_string(body.size()) + " bytes follow (shape too large, or file cut)");
  }
  const std::size_t size = bytes_of(rows, stride);
  if (body.size() > size) warnings.push_back(std::to_string(body.size() - size) + " trailing (extra) bytes after the array are not used");
  if (header.is_in_rows()) {
    points.data.assign(body.substr(0, size));
  } else {
    points.data = rows_of_columns(body.data(), static_cast<std::size_t>(rows), points.properties);
  }
  if (header.is_padded()) drop_padding(points);
  if (header.big_endian) swap_records(points);
  if (header.half) {
    std::string wide(bytes_of(2, size), '\0');
    for (std::size_t k = 0; k < size / 2; ++k) {
      const float value = half_to_float(load<std::uint16_t>(points.data.data() + 2 * k));
      std::memcpy(wide.data() + 4 * k, &value, sizeof value);
    }
    points.data = std::move(wide);
    for (Property& property : points.properties) property.type = Type::kFloat32;
  }
  if (!header.is_structured() && FourthToSixth::exist(points)) {
    FourthToSixth columns(points);
    columns.add(points.data.data(), static_cast<std::size_t>(rows));
    columns.name(points.properties);
  }
  return points;
}

// Names columns 4 to 6 of rows that lie in a file.
void name_stored(StoredTable& stored, const RandomFile& file) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // bytes of rows read at once
  Element& points = stored.table.elements[0];
  const std::size_t stride = points.stride();
  FourthToSixth columns(points);
  std::string rows;
  std::uint64_t at = stored.begin;
  for (std::uint64_t left = points.count; left > 0;) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left, std::max<std::size_t>(1, kAtOnce / stride)));
    rows.resize(count * stride);
    file.read(at, rows.data(), rows.size());
    if (!columns.add(rows.data(), count)) break;
    at += rows.size();
    left -= count;
  }
  columns.name(points.properties);
}

}  // namespace

Cloud read_npy(const Source& source) {
  const NpyHeader header = read_npy_header(source);
  Cloud cloud;
  cloud.format = "npy";
  fill_cloud(source, Attributes::of_points(Attributes::Dialect::kText, make_points(source, header, cloud.warnings)), cloud);
  return cloud;
}

std::optional<StoredTable> find_npy_records(const Source& head, const RandomFile& file) {
  constexpr std::size_t kVersion = 6;  // byte; then the length of the header, in two bytes in version 1 and four in later ones
  constexpr std::size_t kLength = 8;
  if (head.bytes.size() < kLength + 4) return std::nullopt;
  const std::size_t length =
      head.bytes[kVersion] == 1 ? load<std::uint16_t>(head.bytes.data() + kLength) : load<std::uint32_t>(head.bytes.data() + kLength);
  if (length > head.bytes.size() - kLength - 4) return std::nullopt;
  const NpyHeader header = read_npy_header(head);
  Element points = describe_points(head, header);
  if (!header.is_in_rows() || header.is_padded() || header.big_endian || header.half) return std::nullopt;
  const bool named = header.is_structured() || !FourthToSixth::exist(points);
  std::optional<StoredTable> stored = stored_table(Attributes::Dialect::kText, {}, std::move(points), header.body, file.size());
  if (stored && !named) name_stored(*stored, file);
  return stored;
}

}  // namespace g3r::io
