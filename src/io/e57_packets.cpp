// Source: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange".
#include "io/e57.h"
#include "io/e57_pages.h"
#include "io/number_type.h"

#include <string_view>

namespace g3r::io {

namespace {

using namespace e57_pages;
using namespace std::string_view_literals;

constexpr std::size_t kSectionHeader = 32;  // its bytes
constexpr std::size_t kDataHeader = 6;      // of a packet of data

}  // namespace

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
