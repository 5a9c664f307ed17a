#include "io/e57_pages.h"

#include "io/number_type.h"

#include <array>
#include <string_view>

namespace g3r::io::e57_pages {

namespace {

constexpr std::size_t kAtOnce = 256 * kPage;  // bytes checked at once; memory does not grow with the file
constexpr std::size_t kVersion = 8;
constexpr std::size_t kFileLength = 16;
constexpr std::size_t kPageSize = 40;

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

}  // namespace

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

}  // namespace g3r::io::e57_pages
