#include "io/ply_body.h"

#include "io/ply_types.h"
#include "io/text.h"
#include "io/text_numbers.h"

#include <algorithm>

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
      return;
    }
    if (element.stride() != 0) {
      read_fixed(element);
    } else {
      read_lists(element);
    }
    if (encoding_ == PlyEncoding::kBigEndian) swap_records(element);
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
    element.data.assign(body_.substr(at_, static_cast<std::size_t>(element.count) * element.stride()));
    at_ += element.data.size();
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
      append_double(property.count_type, count, element.data);
    }
    for (std::uint64_t k = 0; k < length; ++k)
      append_double(property.type, text_number(element, property, property.type, tokens), element.data);
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

  const Source& source_;
  PlyEncoding encoding_;
  std::string_view body_;
  std::size_t body_offset_;
  Lines lines_;         // text
  std::size_t at_ = 0;  // binary
  bool overflow_ = false;
  bool last_line_open_ = false;
};

}  // namespace

void read_ply_body(const Source& source, PlyHeader& header, std::vector<std::string>& warnings) {
  BodyReader body(source, header);
  for (Element& element : header.elements) body.read(element);
  body.finish(warnings);
  if (body.overflow()) warnings.emplace_back(kOverflow);
  if (body.last_line_open()) warnings.emplace_back(kOpenEnd);
}

}  // namespace g3r::io
