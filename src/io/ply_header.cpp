#include "io/ply_header.h"

#include "io/ply_types.h"
#include "io/text.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <optional>

namespace g3r::io {

namespace {

// The lines of a header. All end with LF (a CR before it is dropped), or all with CR where the first does: only then is the first byte of a
// binary body certain.
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view bytes) : bytes_(bytes) {
    const std::size_t end = bytes.find_first_of("\r\n");
    const bool cr = end != std::string_view::npos && bytes[end] == '\r' && bytes.substr(end + 1, 1) != "\n";
    end_ = cr ? '\r' : '\n';
  }
  bool next(std::string_view& line) {
    const std::size_t end = bytes_.find(end_, at_);
    if (end == std::string_view::npos) return false;
    line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    ++number_;
    return true;
  }
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] std::size_t offset() const { return at_; }

 private:
  std::string_view bytes_;
  char end_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
};

class HeaderParser {
 public:
  explicit HeaderParser(const Source& source) : source_(source), lines_(source.bytes) {}

  PlyHeader parse() {
    std::string_view line;
    lines_.next(line);  // the magic, recognised already
    reserve();
    while (lines_.next(line)) {
      Tokens words(line);
      std::string_view keyword;
      if (!words.next(keyword)) {
        if (line.empty() || trim(line).empty()) continue;
      } else if (keyword == "end_header") {
        header_.body = lines_.offset();
        header_.lines = lines_.number();
        check();
        return std::move(header_);
      } else {
        statement(keyword, words, line);
      }
    }
    fail(source_, "the header does not end: expected a line \"end_header\", found the end of the file (truncated?)");
  }

 private:
  // Elements and comments are counted first, so that vectors do not grow past what a short line is worth.
  void reserve() {
    HeaderLines lines = lines_;
    std::string_view line;
    std::size_t elements = 0;
    std::size_t comments = 0;
    while (lines.next(line) && line.substr(0, 10) != "end_header") {
      elements += line.substr(0, 7) == "element" ? 1 : 0;
      comments += line.substr(0, 7) == "comment" || line.substr(0, 8) == "obj_info" ? 1 : 0;
    }
    header_.elements.reserve(elements);
    header_.comments.reserve(comments);
  }

  void statement(std::string_view keyword, Tokens& words, std::string_view line) {
    if (keyword == "comment" || keyword == "obj_info") {
      while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      header_.comments.emplace_back(line);
    } else if (keyword == "format") {
      format(words);
    } else if (keyword == "element") {
      element(words);
    } else if (keyword == "property") {
      property(words);
    } else {
      fail_here("unknown keyword " + quote(keyword) +
                " in the header: expected format, comment, obj_info, element, property or end_header");
    }
  }

  void format(Tokens& words) {
    if (encoding_) fail_here("a second format line in the header");
    std::string_view name;
    std::string_view version;
    words.next(name);
    words.next(version);
    if (name == "ascii") {
      encoding_ = PlyEncoding::kText;
    } else if (name == "binary_little_endian") {
      encoding_ = PlyEncoding::kLittleEndian;
    } else if (name == "binary_big_endian") {
      encoding_ = PlyEncoding::kBigEndian;
    } else {
      fail_here("expected the format ascii, binary_little_endian or binary_big_endian, found " + quote(name));
    }
    if (version != "1.0") fail_here("expected format version 1.0, found " + quote(version));
    no_more(words);
    header_.encoding = *encoding_;
  }

  void element(Tokens& words) {
    std::string_view name;
    std::string_view count;
    if (!words.next(name)) fail_here("expected \"element NAME COUNT\", found no name");
    words.next(count);
    Element added;
    added.name = std::string(name);
    added.count = parse_count(source_, lines_.number(), count, "count of element " + quote(name));
    no_more(words);
    header_.elements.push_back(std::move(added));
  }

  void property(Tokens& words) {
    if (header_.elements.empty()) fail_here("a property before any element");
    Property added;
    std::string_view word;
    words.next(word);
    if (word == "list") {
      added.list = true;
      words.next(word);
      added.count_type = type(word);
      if (is_float(added.count_type)) fail_here("expected an integer type for the count of a list, found " + quote(word));
      words.next(word);
    }
    added.type = type(word);
    if (!words.next(word)) fail_here("expected \"property TYPE NAME\", found no name");
    added.name = std::string(word);
    no_more(words);
    header_.elements.back().properties.push_back(std::move(added));
  }

  Type type(std::string_view name) {
    const std::optional<Type> found = ply_type_of(name);
    if (!found) fail_here("unknown property type " + quote(name) + ": expected char, uchar, short, ushort, int, uint, float or double");
    return *found;
  }

  void no_more(Tokens& words) {
    std::string_view word;
    if (words.next(word)) fail_here("unexpected " + quote(word) + " at the end of a header line");
  }

  void check() {
    if (!encoding_) fail(source_, "no format line in the header");
    check_distinct(header_.elements, "element");
    for (const Element& e : header_.elements) check_distinct(e.properties, "property");
    const auto vertex = std::find_if(header_.elements.begin(), header_.elements.end(), [](const Element& e) { return e.name == "vertex"; });
    if (vertex == header_.elements.end()) fail(source_, "no points: the header has no element \"vertex\"");
    header_.vertex = static_cast<std::size_t>(vertex - header_.elements.begin());
  }

  template <class Named>
  void check_distinct(const std::vector<Named>& items, const char* what) const {
    std::vector<std::string_view> names;
    names.reserve(items.size());
    for (const Named& item : items) names.push_back(item.name);
    std::sort(names.begin(), names.end());
    const auto twin = std::adjacent_find(names.begin(), names.end());
    if (twin != names.end())
      fail(source_, std::string("the ") + what + " " + quote(*twin) + " is declared twice (duplicate) in the header");
  }

  [[noreturn]] void fail_here(const std::string& what) const { fail_at_line(source_, lines_.number(), what); }

  const Source& source_;
  HeaderLines lines_;
  PlyHeader header_;
  std::optional<PlyEncoding> encoding_;
};

}  // namespace

PlyHeader read_ply_header(const Source& source) { return HeaderParser(source).parse(); }

}  // namespace g3r::io
