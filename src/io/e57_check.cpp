// Source: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange", and libE57Format, which reads only checked files here.
#include "io/e57.h"
#include "io/e57_pages.h"
#include "io/number_type.h"

#include <algorithm>

namespace g3r::io {

namespace {

using namespace e57_pages;

constexpr std::size_t kXmlAt = 24;
constexpr std::size_t kXmlLength = 32;

// libE57Format walks the tree of elements recursively, looks at all children of a structure when it gets another, and compares every new
// child of a vector of one type with all others, trees and all.
constexpr std::size_t kMostDepth = 32;
constexpr std::size_t kMostMembers = 256;    // of a structure
constexpr std::size_t kMostEqual = 512;      // numbers or texts in a vector of one type
constexpr std::size_t kMostChildren = 4096;  // of anything else
constexpr std::size_t kMostElements = 200'000;
constexpr std::size_t kMostAttributes = 64;  // of an element: they take many times their bytes

// The structure of the XML, without regard to what it says. Errors of syntax are left to the parser.
class XmlCheck {
 public:
  XmlCheck(const Source& source, std::string_view xml, std::size_t at) : source_(source), xml_(xml), at_(at) {}

  void run() {
    check_encoding();
    for (std::size_t i = xml_.find('<'); i != std::string_view::npos; i = xml_.find('<', i)) {
      const std::string_view rest = xml_.substr(i);
      if (rest.starts_with("<!--")) {
        i = past("-->", i + 4);
      } else if (rest.starts_with("<![CDATA[")) {
        i = past("]]>", i);
      } else if (rest.starts_with("<?")) {
        i = past("?>", i);
      } else if (rest.starts_with("<!")) {
        refuse("a document type or entity, which E57 does not have");
      } else if (rest.starts_with("</")) {
        close();
        i = past(">", i);
      } else {
        i = open(i + 1);
      }
    }
  }

 private:
  struct Open {
    bool compressed_vector;
    bool of_one_type;
    std::size_t most_children;
    std::size_t children = 0;
    bool prototype = false;
  };

  void check_encoding() {
    constexpr std::size_t kDeclaration = 256;  // The declaration ends within so many bytes, so that no more are searched.
    if (!xml_.starts_with("<?xml ")) refuse("expected \"<?xml \" at its begin, in UTF-8");
    const std::string_view declaration = xml_.substr(0, std::min(xml_.find("?>"), kDeclaration));
    const std::size_t encoding = declaration.find("encoding");
    if (encoding != std::string_view::npos) {
      std::string name(declaration.substr(encoding + 8, 16));
      for (char& c : name) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
      if (name.find("\"UTF-8\"") == std::string::npos && name.find("'UTF-8'") == std::string::npos) refuse("expected the encoding UTF-8");
    }
    if (xml_.find('\0') != std::string_view::npos) refuse("a zero byte, expected UTF-8");
  }

  // An opening tag whose name is at `i`; returns what follows it.
  std::size_t open(std::size_t i) {
    const std::size_t name_end = std::min(xml_.find_first_of(" \t\r\n/>", i), xml_.size());
    const std::string_view name = xml_.substr(i, name_end - i);
    std::string_view type;
    std::string_view hetero;
    std::size_t attributes = 0;
    i = name_end;
    while (i < xml_.size() && xml_[i] != '>' && xml_[i] != '/') {
      if (std::string_view(" \t\r\n").find(xml_[i]) != std::string_view::npos) {
        ++i;
        continue;
      }
      if (++attributes > kMostAttributes) refuse("an element with more than " + std::to_string(kMostAttributes) + " attributes");
      const std::size_t begin = i;
      i = std::min(xml_.find_first_of("=>", i), xml_.size());
      const std::string_view attribute = xml_.substr(begin, xml_.find_first_of(" \t\r\n=>", begin) - begin);
      i = std::min(xml_.find_first_of("\"'>", i), xml_.size());
      if (i == xml_.size() || xml_[i] == '>') break;
      const std::size_t quote = i++;
      i = past(xml_.substr(quote, 1), i);
      const std::string_view value = xml_.substr(quote + 1, i - quote - 2);
      if (attribute.find("chemaLocation") != std::string_view::npos) refuse("a schema, which would have to be fetched");
      if (attribute == "type") type = value;
      if (attribute == "allowHeterogeneousChildren") hetero = value;
    }
    if (type.find('&') != std::string_view::npos) refuse("a type that is spelled with entities");
    if (++elements_ > kMostElements) refuse("more than " + std::to_string(kMostElements) + " elements");
    if (!open_.empty()) {
      Open& parent = open_.back();
      const bool tree = type == "Structure" || type == "Vector" || type == "CompressedVector";
      if (++parent.children > parent.most_children)
        refuse("an element with more than " + std::to_string(parent.most_children) + " children");
      if (parent.of_one_type && tree && parent.children > 1) refuse("structures in a vector of one type");
      parent.prototype = parent.prototype || name == "prototype";
    }
    const bool of_one_type = type == "Vector" && hetero != "1";
    open_.push_back({type == "CompressedVector", of_one_type,
                     type == "Structure" ? kMostMembers
                     : of_one_type       ? kMostEqual
                                         : kMostChildren});
    if (open_.size() > kMostDepth) refuse("elements nested deeper than " + std::to_string(kMostDepth));
    if (i < xml_.size() && xml_[i] == '/') close();
    return past(">", i);
  }

  void close() {
    if (open_.empty()) refuse("an end tag without a begin");
    if (open_.back().compressed_vector && !open_.back().prototype) refuse("a compressed vector without a prototype");
    open_.pop_back();
  }

  // What follows the next `end`.
  std::size_t past(std::string_view end, std::size_t i) const {
    const std::size_t found = xml_.find(end, i);
    if (found == std::string_view::npos) refuse("truncated: no \"" + std::string(end) + "\" where it should be");
    return found + end.size();
  }

  [[noreturn]] void refuse(const std::string& what) const {
    fail_at_byte(source_, at_, "the XML of the E57 file cannot be read: " + what + "; export the file anew");
  }

  const Source& source_;
  std::string_view xml_;
  std::size_t at_;
  std::vector<Open> open_;
  std::size_t elements_ = 0;
};

}  // namespace

void check_e57(FileBytes& file) {
  check_pages(file);
  const Source& source = file.source();
  const std::string header(file.get(0, kFileHeader));
  const auto physical = load<std::uint64_t>(header.data() + kXmlAt);
  const auto length = load<std::uint64_t>(header.data() + kXmlLength);
  const std::uint64_t at = to_logical(physical);
  if (physical < kFileHeader || physical % kPage >= kPayload || at >= logical_size(file) || length > logical_size(file) - at) {
    fail_at_byte(source, kXmlAt,
                 "truncated or damaged: the XML, " + std::to_string(length) + " bytes at " + std::to_string(physical) +
                     ", does not lie within the file");
  }
  XmlCheck(source, load_logical(file, at, static_cast<std::size_t>(length)), static_cast<std::size_t>(physical)).run();
}

}  // namespace g3r::io
