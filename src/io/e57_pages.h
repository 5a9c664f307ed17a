// The pages that an E57 file consists of: 1024 bytes each, of which the last 4 are a checksum. Sections of the file are addressed by
// "physical" offsets, into the file, or "logical" ones, without the checksums. Source: ASTM E2807-11.
#pragma once

#include "io/file_bytes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace g3r::io::e57_pages {

inline constexpr std::size_t kPage = 1024;      ///< bytes of a page in the file
inline constexpr std::size_t kPayload = 1020;   ///< of them all but the checksum
inline constexpr std::size_t kFileHeader = 48;  ///< its bytes

inline std::uint64_t to_logical(std::uint64_t physical) {
  return physical / kPage * kPayload + std::min<std::uint64_t>(physical % kPage, kPayload);
}
inline std::uint64_t to_physical(std::uint64_t logical) { return logical / kPayload * kPage + logical % kPayload; }
inline std::uint64_t logical_size(const FileBytes& file) { return file.size() / kPage * kPayload; }

/// `size` bytes from a logical offset on, which lie within the file.
std::string load_logical(FileBytes& file, std::uint64_t offset, std::size_t size);

/// Checks the size, the version and every checksum. O(size) time. Throws InvalidInput, which names the first bad page.
void check_pages(FileBytes& file);

}  // namespace g3r::io::e57_pages
