#include "io/e57_xml.h"

#include <array>
#include <string_view>
#include <utility>

namespace g3r_e57_xml {

namespace {

constexpr std::string_view kDeclaresPrefix = "xmlns:";

// "nor:normalX" -> "normalX"
const char* local_name_of(const std::string& name) {
  const std::size_t colon = name.find(':');
  return name.c_str() + (colon == std::string::npos ? 0 : colon + 1);
}

}  // namespace

SAXParseException::SAXParseException(std::string message, std::string_view text, std::size_t offset) : message_(std::move(message)) {
  const std::string_view before = text.substr(0, offset);
  line_ = 1 + static_cast<XMLFilePos>(std::count(before.begin(), before.end(), '\n'));
  column_ = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0
}

bool Attributes::getIndex(const XMLCh* name, XMLSize_t& index) const {
  const auto found = std::find_if(attributes_.begin(), attributes_.end(), [&](const auto& a) { return a.name == name; });
  index = static_cast<XMLSize_t>(found - attributes_.begin());
  return found != attributes_.end();
}

const XMLCh* Attributes::getLocalName(XMLSize_t i) const { return local_name_of(attributes_[i].name); }

const XMLCh* Attributes::getURI(XMLSize_t i) const {
  return attributes_[i].name.starts_with(kDeclaresPrefix) ? "http://www.w3.org/2000/xmlns/" : "";
}

void SAX2XMLReader::parse(const InputSource& source) {
  const std::unique_ptr<BinInputStream> stream(source.makeStream());
  std::string xml;
  std::array<XMLByte, 16384> block;
  while (const XMLSize_t size = stream->readBytes(block.data(), block.size()))
    xml.append(reinterpret_cast<const char*>(block.data()), size);
  try {
    g3r::io::parse_xml(xml, *this);
  } catch (const g3r::io::XmlError& error) {
    handler_->fatalError({error.what(), xml, error.offset});
    throw;
  }
}

void SAX2XMLReader::begin(const std::string& name, const std::vector<g3r::io::XmlAttribute>& attributes) {
  handler_->startElement("", local_name_of(name), name.c_str(), Attributes(attributes));
}

void SAX2XMLReader::end(const std::string& name) { handler_->endElement("", local_name_of(name), name.c_str()); }

void SAX2XMLReader::text(const std::string& text) { handler_->characters(text.c_str(), text.size()); }

}  // namespace g3r_e57_xml
