#include "io/lzf.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace g3r::io {

namespace {

// The format: bytes in a literal run, bytes of a match, and how far back it begins, at most.
constexpr std::size_t kLiteralRun = 32;
constexpr std::size_t kLongestMatch = 264;
constexpr std::size_t kFarthest = 8192;

// Calls literal(count, position in the stream) and match(count, distance); false if the stream is damaged.
template <class Literal, class Match>
bool walk(std::string_view stream, const Literal& literal, const Match& match) {
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(stream[i])); };
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t control = byte(at++);
    if (control < kLiteralRun) {
      const std::size_t count = control + 1;
      if (count > stream.size() - at) return false;
      literal(count, at);
      at += count;
      continue;
    }
    std::size_t count = (control >> 5) + 2;
    if (count == 9) {
      if (at >= stream.size()) return false;
      count += byte(at++);
    }
    if (at >= stream.size()) return false;
    const std::size_t distance = ((control & 31) << 8 | byte(at++)) + 1;
    if (!match(count, distance)) return false;
  }
  return true;
}

}  // namespace

std::optional<std::size_t> lzf_size(std::string_view stream) {
  std::size_t size = 0;
  const bool sound = walk(
      stream, [&](std::size_t count, std::size_t) { size += count; },
      [&](std::size_t count, std::size_t distance) {
        if (distance > size) return false;
        size += count;
        return true;
      });
  return sound ? std::optional(size) : std::nullopt;
}

std::string lzf_expand(std::string_view stream, std::size_t size) {
  std::string bytes;
  bytes.reserve(size);
  walk(
      stream, [&](std::size_t count, std::size_t at) { bytes.append(stream.substr(at, count)); },
      [&](std::size_t count, std::size_t distance) {
        for (std::size_t k = 0; k < count; ++k) bytes += bytes[bytes.size() - distance];
        return true;
      });
  return bytes;
}

std::string lzf_compress(std::string_view bytes) {
  std::string stream;
  std::array<std::size_t, 1 << 14> last{};  // position + 1 of the last three bytes with this hash
  std::size_t literals = 0;                 // position of the first byte not yet written
  const auto flush = [&](std::size_t end) {
    for (; literals < end;) {
      const std::size_t count = std::min(kLiteralRun, end - literals);
      stream += static_cast<char>(count - 1);
      stream.append(bytes.substr(literals, count));
      literals += count;
    }
  };
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])); };
  for (std::size_t at = 0; at + 2 < bytes.size();) {
    const std::uint32_t hash = (byte(at) << 16 | byte(at + 1) << 8 | byte(at + 2)) * 2654435761U >> 18;
    const std::size_t candidate = last[hash];
    last[hash] = at + 1;
    if (candidate == 0 || at - (candidate - 1) > kFarthest || bytes.substr(candidate - 1, 3) != bytes.substr(at, 3)) {
      ++at;
      continue;
    }
    const std::size_t from = candidate - 1;
    std::size_t count = 3;
    while (count < kLongestMatch && at + count < bytes.size() && bytes[from + count] == bytes[at + count]) ++count;
    flush(at);
    const std::size_t distance = at - from - 1;
    const std::size_t length = count - 2;
    stream += static_cast<char>(std::min<std::size_t>(length, 7) << 5 | distance >> 8);
    if (length >= 7) stream += static_cast<char>(length - 7);
    stream += static_cast<char>(distance & 255);
    at += count;
    literals = at;
  }
  flush(bytes.size());
  return stream;
}

}  // namespace g3r::io
