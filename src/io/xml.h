// A reader of XML for files that have neither document types nor schemas (E57): elements, attributes and text, as they come.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

struct XmlAttribute {
  std::string name;
  std::string value;
};

/// What takes the parts of a text. Names have their prefixes: "nor:normalX"; declarations of prefixes ("xmlns:nor") are attributes.
class XmlEvents {
 public:
  virtual void begin(const std::string& name, const std::vector<XmlAttribute>& attributes) = 0;
  virtual void end(const std::string& name) = 0;
  /// Between tags; an element's text may come in several pieces.
  virtual void text(const std::string& text) = 0;

 protected:
  ~XmlEvents() = default;
};

/// The text is not XML, or has what this reader does not take.
class XmlError : public std::runtime_error {
 public:
  XmlError(const std::string& what, std::size_t at) : std::runtime_error(what), offset(at) {}
  std::size_t offset;  ///< of the place, in bytes
};

/// Reads one document of UTF-8, to its last byte: XML 1.0 (fifth edition) without document types, and so without entities but the five
/// that need no declaration. Comments and processing instructions are skipped. Takes O(size) time, and memory for the names of the
/// elements that are open; no recursion. Throws XmlError, and whatever the events throw.
void parse_xml(std::string_view xml, XmlEvents& events);

}  // namespace g3r::io
