// Source: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange", and libE57Format, which reads only checked files here.
#include "io/e57.h"

#include "io/table.h"

#include <algorithm>
#include <array>

namespace g3r::io {

namespace {

using namespace std::string_view_literals;

constexpr std::size_t kPage = 1024;           // bytes of a page in the file ("physical")
constexpr std::size_t kPayload = 1020;        // of them all but a checksum ("logical")
constexpr std::size_t kAtOnce = 256 * kPage;  // bytes checked at once; memory does not grow with the file
constexpr std::size_t kFileHeader = 48;
constexpr std::size_t kVersion = 8;
constexpr std::size_t kFileLength = 16;
constexpr std::size_t kXmlAt = 24;
constexpr std::size_t kXmlLength = 32;
constexpr std::size_t kPageSize = 40;
constexpr std::size_t kSectionHeader = 32;
constexpr std::size_t kDataHeader = 6;  // of a packet of data

// libE57Format walks the tree of elements recursively, looks at all children of a structure when it gets another, and compares every new
// child of a vector of one type with all others, trees and all.
constexpr std::size_t kMostDepth = 32;
constexpr std::size_t kMostMembers = 256;    // of a structure
constexpr std::size_t kMostEqual = 512;      // numbers or texts in a vector of one type
constexpr std::size_t kMostChildren = 4096;  // of anything else
constexpr std::size_t kMostElements = 200'000;
constexpr std::size_t kMostAttributes = 64;  // of an element: they take many times their bytes

// CRC-32C (Castagnoli), reflected.
std::array<std::uint32_t, 256> crc_table() {
  constexpr std::uint32_t kPolynomial = 0x82F63B78;
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? kPolynomial : 0);
    table[byte] = crc;
  }
  return table;
}

std::uint32_t crc_of(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = crc_table();
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char byte : bytes) crc = crc >> 8 ^ table[(crc ^ static_cast<unsigned char>(byte)) & 0xFF];
  return ~crc;
}

std::uint32_t load_big(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

std::uint64_t to_logical(std::uint64_t physical) {
  return physical / kPage * kPayload + std::min<std::uint64_t>(physical % kPage, kPayload);
}

std::uint64_t to_physical(std::uint64_t logical) { return logical / kPayload * kPage + logical % kPayload; }

std::uint64_t logical_size(const FileBytes& file) { return file.size() / kPage * kPayload; }

// The bytes of the pages without their checksums; they lie within the file.
std::string load_logical(FileBytes& file, std::uint64_t offset, std::size_t size) {
  std::string bytes;
  bytes.reserve(size);
  while (bytes.size() < size) {
    const std::uint64_t at = offset + bytes.size();
    const std::size_t rest = kPayload - static_cast<std::size_t>(at % kPayload);
    bytes += file.get(static_cast<std::size_t>(to_physical(at)), std::min(rest, size - bytes.size()));
  }
  return bytes;
}

void check_pages(FileBytes& file) {
  const Source& source = file.source();
  if (file.size() < kPage) fail_at_byte(source, file.size(), "truncated: an E57 file has at least one page of 1024 bytes");
  const std::string header(file.get(0, kFileHeader));
  const auto length = load<std::uint64_t>(header.data() + kFileLength);
  if (length != file.size() || length % kPage != 0) {
    fail_at_byte(source, kFileLength,
                 "truncated or damaged: the header states " + std::to_string(length) +
                     " bytes, expected a multiple of 1024 and the size, " + std::to_string(file.size()) + "; get the file again");
  }
  const auto major = load<std::uint32_t>(header.data() + kVersion);
  const auto page = load<std::uint64_t>(header.data() + kPageSize);
  if (major != 1) fail_at_byte(source, kVersion, "expected E57 version 1, found " + std::to_string(major));
  if (page != kPage) fail_at_byte(source, kPageSize, "expected pages of 1024 bytes, found " + std::to_string(page));
  for (std::size_t begin = 0; begin < file.size(); begin += kAtOnce) {
    const std::string_view pages = file.get(begin, std::min(kAtOnce, file.size() - begin));
    for (std::size_t at = 0; at < pages.size(); at += kPage) {
      if (crc_of(pages.substr(at, kPayload)) != load_big(pages.data() + at + kPayload)) {
        fail_at_byte(source, begin + at, "damaged: these 1024 bytes do not have their checksum; get the file again, or export it anew");
      }
    }
  }
}

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

std::vector<std::uint64_t> check_e57_packets(FileBytes& file, std::uint64_t section, std::size_t streams) {
  const Source& source = file.source();
  const auto place = [](std::uint64_t logical) { return static_cast<std::size_t>(to_physical(logical)); };
  const std::uint64_t size = logical_size(file);
  if (section < kFileHeader || section >= size || size - section < kSectionHeader) {
    fail(source, "truncated or damaged: a scan's points at byte " + std::to_string(to_physical(section)) + " are not in the file");
  }
  const std::string header = load_logical(file, section, kSectionHeader);
  const auto section_length = load<std::uint64_t>(header.data() + 8);
  std::uint64_t at = to_logical(load<std::uint64_t>(header.data() + 16));
  if (header.substr(0, 8) != "\1\0\0\0\0\0\0\0"sv || section_length > size - section || at < section + kSectionHeader ||
      at >= section + section_length) {
    fail_at_byte(source, place(section), "damaged: expected a section of packed points that lies within the file");
  }
  const std::uint64_t end = section + section_length;
  std::vector<std::uint64_t> bytes(streams);
  for (bool first = true; at < end; first = false) {
    enum : char { kIndex, kData, kEmpty };
    const auto damaged = [&](const std::string& what) { fail_at_byte(source, place(at), "damaged packet of points: " + what); };
    if (end - at < kDataHeader) damaged("expected at least 6 bytes until the end of its section");
    const std::string packet = load_logical(file, at, kDataHeader);
    const std::size_t length = std::size_t{load<std::uint16_t>(packet.data() + 2)} + 1;
    if (length % 4 != 0 || length < 4 || length > end - at) damaged("length " + std::to_string(length));
    if (packet[0] < kIndex || packet[0] > kEmpty || (first && packet[0] != kData)) damaged("type " + std::to_string(packet[0]));
    if (packet[0] == kData) {
      const std::size_t count = load<std::uint16_t>(packet.data() + 4);
      if (count != streams || kDataHeader + 2 * count > length) {
        damaged("expected " + std::to_string(streams) + " streams, one per field, found " + std::to_string(count));
      }
      const std::string lengths = load_logical(file, at + kDataHeader, 2 * count);
      std::size_t sum = kDataHeader + 2 * count;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t stream = load<std::uint16_t>(lengths.data() + 2 * i);
        bytes[i] += stream;
        sum += stream;
      }
      if (sum > length || sum + 3 < length) damaged("its streams do not fill it");
      if (load_logical(file, at + sum, length - sum).find_first_not_of('\0') != std::string::npos) damaged("its end is not zero");
    }
    at += length;
  }
  return bytes;
}

}  // namespace g3r::io
