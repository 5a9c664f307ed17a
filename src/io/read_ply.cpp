// PLY: ascii and binary, either byte order. Every element is kept record by record; nothing is allocated that the body does not fill.
#include "io/cloud_from_table.h"
#include "io/ply_header.h"
#include "io/polygons.h"
#include "io/readers.h"
#include "io/splats.h"
#include "io/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r::io {

namespace {

std::string records_of(const Element& element) { return std::to_string(element.count) + " records of element " + quote(element.name); }

// Least bytes of one record.
std::size_t least_record(const Element& element, PlyEncoding encoding) {
  if (encoding == PlyEncoding::kText) return 2 * element.properties.size();  // a digit and what separates it from the next
  std::size_t bytes = 0;
  for (const Property& property : element.properties) bytes += size_of(property.list ? property.count_type : property.type);
  return bytes;
}

// Reads the bodies of the elements, in the order of the header.
class BodyReader {
 public:
  BodyReader(const Source& source, const PlyHeader& header)
      : source_(source),
        encoding_(header.encoding),
        body_(source.bytes.substr(header.body)),
        body_offset_(header.body),
        lines_(body_, header.lines) {}

  void read(Element& element) {
    if (element.properties.empty()) return;  // records without bytes, however many
    const std::uint64_t left = body_.size() - position() + (encoding_ == PlyEncoding::kText ? 1 : 0);  // the last line may lack its end
    if (element.count > left / least_record(element, encoding_)) {
      fail_at_byte(source_, body_offset_ + position(),
                   "truncated: the header declares " + records_of(element) + ", but only " + std::to_string(body_.size() - position()) +
                       " bytes follow (count too large, or unexpected end of file)");
    }
    if (encoding_ == PlyEncoding::kText) {
      read_text(element);
    } else if (element.stride() != 0) {
      read_fixed(element);
    } else {
      read_lists(element);
    }
  }

  // What follows the last record.
  void finish(std::vector<std::string>& warnings) {
    std::string_view rest = body_.substr(position());
    if (encoding_ == PlyEncoding::kText) {
      while (!rest.empty() && (rest.front() == '\n' || trim(rest.substr(0, 1)).empty())) rest.remove_prefix(1);
      if (!rest.empty()) warnings.push_back(std::to_string(rest.size()) + " trailing bytes after the last element are not used");
      return;
    }
    if (rest.empty()) return;
    if (std::all_of(body_.begin(), body_.end(), [](char c) { return (c >= ' ' && c <= '~') || c == '\n' || c == '\r' || c == '\t'; })) {
      fail_at_byte(source_, body_offset_,
                   "expected binary records, found text that goes on after the last of them (trailing " + std::to_string(rest.size()) +
                       " bytes; is the format line wrong?)");
    }
    warnings.push_back(std::to_string(rest.size()) + " trailing bytes after the last element are not used");
  }

  /// Whether a number was beyond double's range (and is infinite now).
  [[nodiscard]] bool overflow() const { return overflow_; }
  /// Whether the last record has no line end.
  [[nodiscard]] bool last_line_open() const { return last_line_open_; }

 private:
  [[nodiscard]] std::size_t position() const { return encoding_ == PlyEncoding::kText ? static_cast<std::size_t>(lines_.offset()) : at_; }

  void read_fixed(Element& element) {
    const std::size_t stride = element.stride();
    element.data.assign(body_.substr(at_, static_cast<std::size_t>(element.count) * stride));
    at_ += element.data.size();
    if (encoding_ != PlyEncoding::kBigEndian) return;
    for (std::size_t record = 0; record < element.data.size(); record += stride) {
      char* number = element.data.data() + record;
      for (const Property& property : element.properties) {
        swap_bytes(property.type, number);
        number += size_of(property.type);
      }
    }
  }

  void read_lists(Element& element) {
    const std::size_t begin = at_;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        if (!property.list) {
          take(element, i, size_of(property.type));
          continue;
        }
        char length_bytes[8];
        const std::size_t size = size_of(property.count_type);
        const char* field = take(element, i, size);
        std::copy_n(field, size, length_bytes);
        if (encoding_ == PlyEncoding::kBigEndian) swap_bytes(property.count_type, length_bytes);
        const double length = load_as_double(property.count_type, length_bytes);
        if (length < 0) {
          fail_at_byte(
              source_, body_offset_ + at_ - size,
              "record " + std::to_string(i) + " of element " + quote(element.name) + ": negative count of list " + quote(property.name));
        }
        take(element, i, static_cast<std::size_t>(length) * size_of(property.type));
      }
    }
    element.data.assign(body_.substr(begin, at_ - begin));
    if (encoding_ == PlyEncoding::kBigEndian) swap_lists(element);
  }

  static void swap_lists(Element& element) {
    char* number = element.data.data();
    const char* end = number + element.data.size();
    while (number != end) {
      for (const Property& property : element.properties) {
        std::size_t length = 1;
        if (property.list) {
          swap_bytes(property.count_type, number);
          length = static_cast<std::size_t>(load_as_double(property.count_type, number));
          number += size_of(property.count_type);
        }
        for (std::size_t k = 0; k < length; ++k, number += size_of(property.type)) swap_bytes(property.type, number);
      }
    }
  }

  // The next `count` bytes of the body.
  const char* take(const Element& element, std::uint64_t record, std::size_t count) {
    if (count > body_.size() - at_) {
      fail_at_byte(source_, body_offset_ + at_,
                   "truncated: unexpected end of file in record " + std::to_string(record) + " of " + records_of(element) + ": expected " +
                       std::to_string(count) + " bytes for a property or list, found " + std::to_string(body_.size() - at_));
    }
    at_ += count;
    return body_.data() + at_ - count;
  }

  void read_text(Element& element) {
    std::size_t properties = 0;
    for (const Property& property : element.properties) properties += property.list ? 0 : size_of(property.type);
    element.data.reserve(bytes_of(element.count, properties));  // at least two bytes of text for each number
    std::string_view line;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!lines_.next_filled(line)) {
        fail_at_line(source_, lines_.number(),
                     "truncated: unexpected end of file after " + std::to_string(i) + " of " + records_of(element));
      }
      if (!lines_.ended() && i + 1 == element.count) last_line_open_ = true;
      Tokens tokens(line);
      for (const Property& property : element.properties) text_property(element, property, tokens);
      std::string_view extra;
      if (tokens.next(extra)) {
        fail_at_line(source_, lines_.number(),
                     "more values than the properties of element " + quote(element.name) + " (column " + quote(extra) + ")");
      }
    }
  }

  void text_property(Element& element, const Property& property, Tokens& tokens) {
    std::uint64_t length = 1;
    if (property.list) {
      const double count = text_number(element, property, property.count_type, tokens);
      if (count < 0) fail_at_line(source_, lines_.number(), "negative count of list " + quote(property.name));
      length = static_cast<std::uint64_t>(count);
      append(property.count_type, count, element.data);
    }
    for (std::uint64_t k = 0; k < length; ++k) append(property.type, text_number(element, property, property.type, tokens), element.data);
  }

  double text_number(const Element& element, const Property& property, Type type, Tokens& tokens) {
    std::string_view token;
    if (!tokens.next(token)) {
      fail_at_line(source_, lines_.number(),
                   "too few values for a record of element " + quote(element.name) + ": expected a number for property " +
                       quote(property.name) + ", found the end of the line" +
                       (lines_.ended() ? "" : " (truncated: unexpected end of file)"));
    }
    double value = 0;
    if (!parse_double(token, value, &overflow_))
      fail_at_line(source_, lines_.number(), expected_number(token) + " for property " + quote(property.name));
    if (!is_float(type)) {
      char stored[8];
      store_double(type, value, stored);
      if (load_as_double(type, stored) != value) {
        fail_at_line(source_, lines_.number(),
                     "expected a number of type " + std::string(ply_type_name(type)) + " for property " + quote(property.name) +
                         ", found " + quote(token));
      }
    }
    return value;
  }

  static void append(Type type, double value, std::string& data) {
    char stored[8];
    store_double(type, value, stored);
    data.append(stored, size_of(type));
  }

  const Source& source_;
  PlyEncoding encoding_;
  std::string_view body_;
  std::size_t body_offset_;
  Lines lines_;         // text
  std::size_t at_ = 0;  // binary
  bool overflow_ = false;
  bool last_line_open_ = false;
};

const char* encoding_name(PlyEncoding encoding) {
  return encoding == PlyEncoding::kText           ? "ply ascii"
         : encoding == PlyEncoding::kLittleEndian ? "ply binary_little_endian"
                                                  : "ply binary_big_endian";
}

std::shared_ptr<Attributes> read_table(const Source& source, Cloud& cloud) {
  PlyHeader header = read_ply_header(source);
  cloud.format = encoding_name(header.encoding);
  BodyReader body(source, header);
  for (Element& element : header.elements) body.read(element);
  body.finish(cloud.warnings);
  if (body.overflow()) cloud.warnings.emplace_back("a number is out of double's range: it is taken as infinite (not finite)");
  if (body.last_line_open()) cloud.warnings.emplace_back("the last line has no line end: the file may be cut");
  auto table = std::make_shared<Attributes>();
  table->comments = std::move(header.comments);
  table->elements = std::move(header.elements);
  table->vertex = header.vertex;
  return table;
}

// The lists of corners of the element "face".
class Faces {
 public:
  explicit Faces(const Attributes& table) {
    const auto face = std::find_if(table.elements.begin(), table.elements.end(), [](const Element& e) { return e.name == "face"; });
    if (face == table.elements.end()) return;
    element_ = &*face;
    indices_ = std::min(face->find("vertex_indices"), face->find("vertex_index"));
  }
  [[nodiscard]] bool exist() const { return element_ != nullptr && indices_ != Element::npos; }
  [[nodiscard]] const Property& list() const { return element_->properties[indices_]; }
  [[nodiscard]] bool are_integer_lists() const { return exist() && list().list && !is_float(list().type); }
  // visit(face, number of corners, address of the first)
  template <class Visit>
  void for_each(const Visit& visit) const {
    RecordLayout layout(*element_);
    const char* record = element_->data.data();
    for (std::uint64_t i = 0; i < element_->count; ++i, record += layout.size()) {
      layout.seek(record);
      const char* field = record + layout.offset(indices_);
      visit(i, static_cast<std::size_t>(load_as_double(list().count_type, field)), field + size_of(list().count_type));
    }
  }

 private:
  const Element* element_ = nullptr;
  std::size_t indices_ = Element::npos;
};

// Faces that cannot be are a sign that the counts of the header are wrong, even if points alone are wanted.
void check_faces(const Attributes& table, std::vector<std::string>& warnings) {
  const Faces faces(table);
  if (!faces.are_integer_lists()) return;
  const auto vertices = static_cast<double>(table.points().count);
  const Type type = faces.list().type;
  std::size_t damaged = 0;
  faces.for_each([&](std::uint64_t, std::size_t corners, const char* corner) {
    bool sound = corners >= 3;
    for (std::size_t k = 0; sound && k < corners; ++k) {
      const double index = load_as_double(type, corner + k * size_of(type));
      sound = index >= 0 && index < vertices;
    }
    damaged += sound ? 0 : 1;
  });
  if (damaged != 0) {
    warnings.push_back(std::to_string(damaged) +
                       " faces have fewer than three corners or name vertices that do not exist: the file may be damaged");
  }
}

}  // namespace

Cloud read_ply(const Source& source, const ReadOptions& options) {
  Cloud cloud;
  std::shared_ptr<Attributes> table = read_table(source, cloud);
  check_faces(*table, cloud.warnings);
  if (is_splat(table->points())) {
    fill_splat_cloud(source, std::move(table), options, cloud);
  } else {
    fill_cloud(source, std::move(table), cloud);
  }
  return cloud;
}

Mesh read_ply_mesh(const Source& source) {
  Cloud cloud;
  const std::shared_ptr<Attributes> table = read_table(source, cloud);
  fill_cloud(source, table, cloud);
  const Faces faces(*table);
  if (!faces.exist()) fail(source, "no faces: a mesh needs an element \"face\" with a list \"vertex_indices\"");
  if (!faces.are_integer_lists()) fail(source, "the property \"vertex_indices\" must be a list of integers");

  Mesh mesh;
  mesh.vertices = std::move(cloud.positions);
  mesh.colors = std::move(cloud.colors);
  mesh.confidence = std::move(cloud.confidence);
  Fans fans(source, mesh);
  faces.for_each([&](std::uint64_t, std::size_t corners, const char*) { fans.count(corners); });
  fans.reserve();
  const Type type = faces.list().type;
  faces.for_each([&](std::uint64_t i, std::size_t corners, const char* corner) {
    fans.begin(i, "face");
    for (std::size_t k = 0; k < corners; ++k, corner += size_of(type)) fans.corner(load_as_double(type, corner));
  });
  return mesh;
}

std::optional<StoredTable> find_ply_records(const Source& head, std::uint64_t file_size) {
  if (head.bytes.find("\nend_header") == std::string_view::npos) return std::nullopt;  // a line of its own, and not in a comment
  PlyHeader header = read_ply_header(head);
  if (header.encoding != PlyEncoding::kLittleEndian || header.vertex != 0) return std::nullopt;
  const Element& points = header.elements[0];
  const std::size_t stride = points.stride();
  if (stride == 0 || is_splat(points) || points.count > (file_size - header.body) / stride) return std::nullopt;
  StoredTable stored;
  stored.begin = header.body;
  stored.table.comments = std::move(header.comments);
  stored.table.elements.push_back(std::move(header.elements[0]));
  return stored;
}

}  // namespace g3r::io
