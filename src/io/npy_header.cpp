#include "io/npy_header.h"

#include "io/text_numbers.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

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
      const std::string_view kind = text.string();
      if (!field.name.empty() || !padding(kind, field)) field.type = type(kind);
      if (text.take(',') && !text.at(')')) text.fail_here("arrays in a structured dtype are not read");
      text.expect(')');
      text.take(',');
      if (header_.fields.size() == kMostFields) text.fail_here("too many fields in the dtype");
      header_.fields.push_back(std::move(field));
    }
    if (header_.half) text.fail_here("float16 in a structured dtype is not read");
  }

  // "|V4": so many bytes without meaning, as NumPy aligns fields with.
  static bool padding(std::string_view descr, Property& field) {
    constexpr std::uint32_t kMostBytes = std::uint32_t{1} << 16;  // More is damage.
    std::uint32_t bytes = 0;
    if (descr.substr(0, 2) != "|V" || !parse_integer(descr.substr(2), bytes) || bytes == 0 || bytes > kMostBytes) return false;
    field.type = Type::kUint8;
    field.count = bytes;
    return true;
  }

  Type type(std::string_view descr) {
    if (descr.size() >= 2) {
      const char order = descr[0];
      const std::string_view code = descr.substr(1);
      const bool big = order == '>';
      const bool ordered = order != '|';  // of numbers of one byte, of which true and false are two
      if (!ordered && code == "b1") return Type::kUint8;
      if ((order == '<' || big || order == '|' || order == '=') && !(ordered && ordered_ && big != header_.big_endian)) {
        header_.big_endian = ordered ? big : header_.big_endian;
        ordered_ = ordered_ || ordered;
        if (code == "f2") {
          header_.half = true;
          return Type::kUint16;  // the bits
        }
        if (const std::optional<Type> known = type_named(code)) return *known;
      }
    }
    fail(source_, "expected the dtype f2, f4, f8, i1..i8, u1..u8 or b1, in one byte order, found " + quote(descr) +
                      " (object arrays are pickles and never loaded)");
  }

  // "f4", "u2" ...: the kind and the bytes.
  static std::optional<Type> type_named(std::string_view code) {
    const std::size_t kind = std::string_view("iuf").find(code[0]);
    if (code.size() != 2 || kind == std::string_view::npos || code[1] < '0') return std::nullopt;
    return type_of(static_cast<NumberKind>(kind), static_cast<std::uint64_t>(code[1] - '0'));
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
  bool ordered_ = false;  // a field has told the order of bytes
};

}  // namespace

bool NpyHeader::is_padded() const {
  return is_structured() && std::any_of(fields.begin(), fields.end(), [](const Property& field) { return field.name.empty(); });
}

NpyHeader read_npy_header(const Source& source) { return NpyParser(source).parse(); }

}  // namespace g3r::io
