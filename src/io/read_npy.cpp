// NPY: N x 3 or more, floats or integers, either byte order, row or column major; or structured with x, y, z. The header is parsed, never
// evaluated, and object arrays are refused. Source: numpy.lib.format.
#include "io/cloud_from_table.h"
#include "io/readers.h"
#include "io/table.h"
#include "io/text.h"

#include <optional>

namespace g3r::io {

namespace {

// A cursor over the Python literal of the header.
class Literal {
 public:
  Literal(const Source& source, std::string_view text) : source_(source), rest_(text) {}
  bool take(char c) {
    skip();
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail_here(std::string("expected ") + quote(std::string(1, c)));
  }
  std::string_view string() {
    skip();
    const char mark = rest_.empty() ? '\0' : rest_.front();
    const std::size_t end = mark == '\'' || mark == '"' ? rest_.find(mark, 1) : std::string_view::npos;
    if (end == std::string_view::npos) fail_here("expected a string");
    const std::string_view text = rest_.substr(1, end - 1);
    rest_.remove_prefix(end + 1);
    return text;
  }
  std::string_view word() {
    skip();
    const std::size_t end = std::min(rest_.find_first_of(",)]} \t\n"), rest_.size());
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return text;
  }
  [[nodiscard]] bool at(char c) {
    skip();
    return !rest_.empty() && rest_.front() == c;
  }
  [[noreturn]] void fail_here(const std::string& what) const {
    fail(source_, "the NPY header is no dictionary of descr, fortran_order and shape: " + what + ", found " + quote(rest_));
  }

 private:
  void skip() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\n' || rest_.front() == '\t')) rest_.remove_prefix(1);
  }
  const Source& source_;
  std::string_view rest_;
};

struct NpyHeader {
  std::vector<Property> fields;  // one without a name for a plain array
  bool big_endian = false;
  bool half = false;  // float16
  bool column_major = false;
  std::vector<std::uint64_t> shape;
  std::size_t body = 0;
};

class NpyParser {
 public:
  explicit NpyParser(const Source& source) : source_(source) {}

  NpyHeader parse() {
    const std::string_view bytes = source_.bytes;
    constexpr std::size_t kFixed = 8;  // magic and version
    if (bytes.size() < kFixed + 4) fail(source_, "truncated: the NPY header ends early");
    const auto major = static_cast<unsigned char>(bytes[6]);
    if (major < 1 || major > 3) fail_at_byte(source_, 6, "expected an NPY header of version 1, 2 or 3, found " + std::to_string(major));
    const std::size_t length_bytes = major == 1 ? 2 : 4;
    const std::size_t length = major == 1 ? load<std::uint16_t>(bytes.data() + kFixed) : load<std::uint32_t>(bytes.data() + kFixed);
    if (length > bytes.size() - kFixed - length_bytes)
      fail_at_byte(source_, kFixed, "truncated: the header's size is " + std::to_string(length) + " bytes, more than the file has");
    header_.body = kFixed + length_bytes + length;
    dictionary(Literal(source_, bytes.substr(kFixed + length_bytes, length)));
    return std::move(header_);
  }

 private:
  void dictionary(Literal text) {
    bool seen[3] = {};
    text.expect('{');
    while (!text.take('}')) {
      const std::string_view key = text.string();
      text.expect(':');
      if (key == "descr") {
        descr(text);
        seen[0] = true;
      } else if (key == "fortran_order") {
        const std::string_view value = text.word();
        if (value != "True" && value != "False") text.fail_here("expected True or False for fortran_order");
        header_.column_major = value == "True";
        seen[1] = true;
      } else if (key == "shape") {
        shape(text);
        seen[2] = true;
      } else {
        text.fail_here("unknown key " + quote(key));
      }
      if (!text.take(',') && !text.at('}')) text.fail_here("expected a comma");
    }
    if (!seen[0] || !seen[1] || !seen[2]) text.fail_here("expected the keys descr, fortran_order and shape");
  }

  void descr(Literal& text) {
    if (!text.take('[')) {
      Property plain;
      plain.type = type(text.string());
      header_.fields.push_back(plain);
      return;
    }
    while (!text.take(']')) {
      text.expect('(');
      Property field;
      field.name = std::string(text.string());
      text.expect(',');
      if (!text.at('\'') && !text.at('"')) text.fail_here("expected a plain dtype for every field of a structured dtype");
      field.type = type(text.string());
      if (text.take(',') && !text.at(')')) text.fail_here("arrays in a structured dtype are not read");
      text.expect(')');
      text.take(',');
      if (header_.fields.size() == kMostFields) text.fail_here("too many fields in the dtype");
      header_.fields.push_back(std::move(field));
    }
    if (header_.half) text.fail_here("float16 in a structured dtype is not read");
  }

  Type type(std::string_view descr) {
    if (descr.size() >= 2) {
      const char order = descr[0];
      const std::string_view code = descr.substr(1);
      const bool big = order == '>';
      if ((order == '<' || big || order == '|' || order == '=') && !(!header_.fields.empty() && big != header_.big_endian)) {
        header_.big_endian = big;
        constexpr std::pair<std::string_view, Type> kCodes[] = {
            {"f4", Type::kFloat32}, {"f8", Type::kFloat64}, {"i1", Type::kInt8},   {"u1", Type::kUint8}, {"i2", Type::kInt16},
            {"u2", Type::kUint16},  {"i4", Type::kInt32},   {"u4", Type::kUint32}, {"i8", Type::kInt64}, {"u8", Type::kUint64}};
        for (const auto& [name, known] : kCodes) {
          if (code == name) return known;
        }
        if (code == "f2") {
          header_.half = true;
          return Type::kUint16;  // the bits
        }
      }
    }
    fail(source_,
         "expected the dtype f2, f4, f8, i1..i8 or u1..u8, found " + quote(descr) + " (object arrays are pickles and never loaded)");
  }

  void shape(Literal& text) {
    text.expect('(');
    while (!text.take(')')) {
      const std::string_view word = text.word();
      std::uint64_t value = 0;
      if (!parse_integer(word, value)) {
        fail(source_, "expected a count in the shape of the header, found " + quote(word) +
                          (word.substr(0, 1) == "-" ? " (negative)" : " (not a number, or too large)"));
      }
      if (header_.shape.size() == 4) text.fail_here("too many dimensions in the shape");
      header_.shape.push_back(value);
      if (!text.take(',') && !text.at(')')) text.fail_here("expected a comma in the shape");
    }
  }

  static constexpr std::size_t kMostFields = 10000;  // Nested types may repeat fields without end; more than this is damage.
  const Source& source_;
  NpyHeader header_;
};

// IEEE 754 binary16 from its bits, as a float.
float half_to_float(std::uint32_t bits) {
  const std::uint32_t sign = (bits & 0x8000U) << 16;
  const std::uint32_t exponent = bits >> 10 & 31U;
  const std::uint32_t fraction = bits & 1023U;
  if (exponent == 31) return bits_as<float>(sign | 0x7F800000U | fraction << 13);
  if (exponent == 0) return (sign != 0 ? -1.0F : 1.0F) * static_cast<float>(fraction) * 0x1p-24F;
  return bits_as<float>(sign | (exponent + 112) << 23 | fraction << 13);
}

bool is_structured(const NpyHeader& header) { return !header.fields[0].name.empty() || header.fields.size() > 1; }

// By number: x y z, then nx ny nz where three more follow, then scalars.
void name_columns(std::vector<Property>& properties) {
  constexpr const char* kNames[] = {"x", "y", "z", "nx", "ny", "nz"};
  const std::size_t named = properties.size() >= 6 ? 6 : 3;
  for (std::size_t c = 0; c < properties.size(); ++c) {
    properties[c].name = c < named ? std::string(kNames[c]) : std::string("scalar_") += std::to_string(c + 1);
  }
}

// The rows as one element without data.
Element describe_points(const Source& source, const NpyHeader& header) {
  if (header.fields.empty()) fail(source, "an empty dtype in the header");
  Element points = make_vertex_element();
  points.properties = header.fields;
  if (is_structured(header)) {
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

// With their data; float16 becomes float32.
Element make_points(const Source& source, const NpyHeader& header, std::vector<std::string>& warnings) {
  Element points = describe_points(source, header);
  const std::uint64_t rows = points.count;
  const bool structured = is_structured(header);
  const std::size_t stride = points.stride();
  const std::string_view body = source.bytes.substr(header.body);
  if (rows > body.size() / stride) {
    fail_at_byte(source, header.body,
                 "truncated: the shape needs " + std::to_string(rows) + " rows of " + std::to_string(stride) + " bytes, but only " +
                     std::to_string(body.size()) + " bytes follow (shape too large, or file cut)");
  }
  const std::size_t size = bytes_of(rows, stride);
  if (body.size() > size) warnings.push_back(std::to_string(body.size() - size) + " trailing (extra) bytes after the array are not used");
  points.data.resize(size);
  char* to = points.data.data();
  const auto row_count = static_cast<std::size_t>(rows);
  for (std::size_t i = 0; i < row_count; ++i) {
    std::size_t offset = 0;
    for (std::size_t c = 0; c < points.properties.size(); ++c) {
      const std::size_t bytes = size_of(points.properties[c].type);
      const std::size_t from = header.column_major && !structured ? (c * row_count + i) * bytes : i * stride + offset;
      std::memcpy(to, body.data() + from, bytes);
      if (header.big_endian) swap_bytes(points.properties[c].type, to);
      to += bytes;
      offset += bytes;
    }
  }
  if (header.half) {
    std::string wide(bytes_of(2, size), '\0');
    for (std::size_t k = 0; k < size / 2; ++k) {
      const float value = half_to_float(load<std::uint16_t>(points.data.data() + 2 * k));
      std::memcpy(wide.data() + 4 * k, &value, sizeof value);
    }
    points.data = std::move(wide);
    for (Property& property : points.properties) property.type = Type::kFloat32;
  }
  return points;
}

}  // namespace

Cloud read_npy(const Source& source) {
  const NpyHeader header = NpyParser(source).parse();
  Cloud cloud;
  cloud.format = "npy";
  auto table = std::make_shared<Attributes>();
  table->dialect = Attributes::Dialect::kText;
  table->elements.push_back(make_points(source, header, cloud.warnings));
  fill_cloud(source, std::move(table), cloud);
  return cloud;
}

std::optional<StoredTable> find_npy_records(const Source& head, std::uint64_t file_size) {
  constexpr std::size_t kVersion = 6;  // byte; then the length of the header, in two bytes in version 1 and four in later ones
  constexpr std::size_t kLength = 8;
  if (head.bytes.size() < kLength + 4) return std::nullopt;
  const std::size_t length =
      head.bytes[kVersion] == 1 ? load<std::uint16_t>(head.bytes.data() + kLength) : load<std::uint32_t>(head.bytes.data() + kLength);
  if (length > head.bytes.size() - kLength - 4) return std::nullopt;
  const NpyHeader header = NpyParser(head).parse();
  Element points = describe_points(head, header);
  const bool in_rows = !header.column_major || is_structured(header);
  if (!in_rows || header.big_endian || header.half || points.count > (file_size - header.body) / points.stride()) return std::nullopt;
  StoredTable stored;
  stored.begin = header.body;
  stored.table.dialect = Attributes::Dialect::kText;
  stored.table.elements.push_back(std::move(points));
  return stored;
}

}  // namespace g3r::io
