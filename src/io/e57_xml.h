// The names of Xerces-C++ that libE57Format reads XML by (E57XmlParser), on parse_xml(). Characters are bytes of UTF-8 here, so nothing is
// converted. The build makes a header that includes this one for each of Xerces-C++'s that libE57Format includes. The namespace is one of
// our own: a program that links g3r and Xerces-C++ has both.
#pragma once

#include "io/xml.h"

#include <algorithm>
#include <cstddef>
#include <cstring>  // libE57Format expects it
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#define XERCES_CPP_NAMESPACE g3r_e57_xml

// NOLINTBEGIN(readability-identifier-naming): the names are Xerces-C++'s
namespace g3r_e57_xml {

using XMLCh = char;
using XMLByte = unsigned char;
using XMLSize_t = std::size_t;
using XMLFilePos = unsigned long long;

enum : XMLCh {
  chNull = 0,
  chLatin_C = 'C',
  chLatin_H = 'H',
  chLatin_O = 'O',
  chLatin_a = 'a',
  chLatin_c = 'c',
  chLatin_d = 'd',
  chLatin_e = 'e',
  chLatin_f = 'f',
  chLatin_g = 'g',
  chLatin_h = 'h',
  chLatin_i = 'i',
  chLatin_l = 'l',
  chLatin_m = 'm',
  chLatin_n = 'n',
  chLatin_o = 'o',
  chLatin_p = 'p',
  chLatin_r = 'r',
  chLatin_s = 's',
  chLatin_t = 't',
  chLatin_u = 'u',
  chLatin_w = 'w',
  chLatin_x = 'x',
  chLatin_y = 'y'
};

struct XMLString {
  static const char* transcode(const XMLCh* text) { return text; }
};

class TranscodeToStr {
 public:
  TranscodeToStr(const XMLCh* text, const char* /*encoding*/) : text_(text) {}
  [[nodiscard]] const XMLByte* str() const { return reinterpret_cast<const XMLByte*>(text_); }

 private:
  const XMLCh* text_;
};

struct MemoryManager {};

struct XMLPlatformUtils {
  static constexpr MemoryManager* fgMemoryManager = nullptr;
  static void Initialize() {}
  static void Terminate() {}
};

// Never thrown: nothing has to be started.
class XMLException {
 public:
  [[nodiscard]] const XMLCh* getMessage() const { return ""; }
};

class SAXParseException {
 public:
  SAXParseException(std::string message, std::string_view text, std::size_t offset);
  [[nodiscard]] const XMLCh* getMessage() const { return message_.c_str(); }
  [[nodiscard]] const XMLCh* getSystemId() const { return "E57File"; }
  [[nodiscard]] XMLFilePos getLineNumber() const { return line_; }
  [[nodiscard]] XMLFilePos getColumnNumber() const { return column_; }

 private:
  std::string message_;
  XMLFilePos line_;
  XMLFilePos column_;
};

class Attributes {
 public:
  explicit Attributes(const std::vector<g3r::io::XmlAttribute>& attributes) : attributes_(attributes) {}
  [[nodiscard]] XMLSize_t getLength() const { return attributes_.size(); }
  bool getIndex(const XMLCh* name, XMLSize_t& index) const;
  [[nodiscard]] const XMLCh* getQName(XMLSize_t i) const { return attributes_[i].name.c_str(); }
  [[nodiscard]] const XMLCh* getValue(XMLSize_t i) const { return attributes_[i].value.c_str(); }
  [[nodiscard]] const XMLCh* getLocalName(XMLSize_t i) const;
  // Of declarations of prefixes alone, which are all that libE57Format asks for.
  [[nodiscard]] const XMLCh* getURI(XMLSize_t i) const;

 private:
  const std::vector<g3r::io::XmlAttribute>& attributes_;
};

class BinInputStream {
 public:
  virtual ~BinInputStream() = default;
  [[nodiscard]] virtual XMLFilePos curPos() const = 0;
  virtual XMLSize_t readBytes(XMLByte* to, XMLSize_t most) = 0;
  [[nodiscard]] virtual const XMLCh* getContentType() const = 0;
};

class InputSource {
 public:
  InputSource(const char* /*name*/, MemoryManager* /*memory*/) {}
  virtual ~InputSource() = default;
  InputSource(const InputSource&) = delete;
  InputSource& operator=(const InputSource&) = delete;
  [[nodiscard]] virtual BinInputStream* makeStream() const = 0;
};

class DefaultHandler {
 public:
  virtual ~DefaultHandler() = default;
  virtual void startElement(const XMLCh* uri, const XMLCh* local_name, const XMLCh* name, const Attributes& attributes) = 0;
  virtual void endElement(const XMLCh* uri, const XMLCh* local_name, const XMLCh* name) = 0;
  virtual void characters(const XMLCh* text, XMLSize_t length) = 0;
  virtual void warning(const SAXParseException& error) = 0;
  virtual void error(const SAXParseException& error) = 0;
  virtual void fatalError(const SAXParseException& error) = 0;
};

struct XMLUni {
  enum Feature {
    fgSAX2CoreValidation,
    fgXercesDynamic,
    fgSAX2CoreNameSpaces,
    fgXercesSchema,
    fgXercesSchemaFullChecking,
    fgSAX2CoreNameSpacePrefixes
  };
};

class SAX2XMLReader : private g3r::io::XmlEvents {
 public:
  virtual ~SAX2XMLReader() = default;
  void setFeature(XMLUni::Feature /*feature*/, bool /*on*/) {}  // namespaces are on, and there is nothing to validate against
  void setContentHandler(DefaultHandler* handler) { handler_ = handler; }
  void setErrorHandler(DefaultHandler* handler) { handler_ = handler; }
  void parse(const InputSource& source);

 private:
  void begin(const std::string& name, const std::vector<g3r::io::XmlAttribute>& attributes) override;
  void end(const std::string& name) override;
  void text(const std::string& text) override;

  DefaultHandler* handler_ = nullptr;
};

struct XMLReaderFactory {
  static SAX2XMLReader* createXMLReader() { return new SAX2XMLReader; }
};

}  // namespace g3r_e57_xml
// NOLINTEND(readability-identifier-naming)
