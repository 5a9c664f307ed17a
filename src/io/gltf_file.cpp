#include "io/gltf_file.h"

#include "io/table.h"

#include <utility>

namespace g3r::io {

namespace {

std::optional<std::string> decode_base64(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int held = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>(bits >> held & 255U);
  }
  return bytes;
}

}  // namespace

GltfFile::GltfFile(const Source& source, std::string_view text, std::optional<std::string_view> binary) : source_(source), binary_(binary) {
  std::optional<Json> root = parse_json(text, affordable_values(source.bytes.size()));
  if (!root) fail(source, "damaged: the JSON of this glTF file is not well formed (truncated?), or has too many values for its size");
  root_ = std::move(*root);
  if (!root_.is_object()) fail(source, "expected a JSON object at the root of a glTF file");
  load_buffers();
}

void GltfFile::load_buffers() {
  const std::vector<Json>& buffers = list("buffers");
  buffers_.reserve(buffers.size());
  for (const Json& buffer : buffers) {
    const Json* address = buffer.find("uri");
    if (address == nullptr) {
      if (!binary_) fail(source_, "a buffer without data");
      buffers_.push_back(*binary_);
      continue;
    }
    const std::string_view uri = address->text;
    const std::size_t comma = uri.find(";base64,");
    if (!uri.starts_with("data:") || comma == std::string_view::npos)
      fail(source_, "the points are in another file, which is not opened: convert to GLB");
    std::optional<std::string> bytes = decode_base64(uri.substr(comma + 8));
    if (!bytes) fail(source_, "damaged base64 data in a buffer");
    decoded_.push_back(std::move(*bytes));
    buffers_.push_back(decoded_.back());
  }
}

const std::vector<Json>& GltfFile::list(std::string_view key) const {
  static const std::vector<Json> nothing;
  const Json* found = root_.find(key);
  if (found == nullptr) return nothing;
  if (!found->is_array()) fail(source_, "expected an array of " + std::string(key));
  return found->items;
}

const Json& GltfFile::member(const Json& object, std::string_view key) const {
  const Json* found = object.find(key);
  if (found == nullptr) fail(source_, "expected the key " + quote(key) + " in this glTF file");
  return *found;
}

std::size_t GltfFile::index(const Json& value, std::size_t size, const char* what) const {
  const std::optional<std::uint64_t> whole = value.whole();
  if (!whole || *whole >= size) fail(source_, std::string("the index of a ") + what + " is out of range");
  return static_cast<std::size_t>(*whole);
}

const Json& GltfFile::item(const std::vector<Json>& array, const Json& value, const char* what) const {
  return array[index(value, array.size(), what)];
}

std::uint64_t GltfFile::whole(const Json& object, std::string_view key, std::uint64_t otherwise) const {
  const Json* found = object.find(key);
  if (found == nullptr) return otherwise;
  const std::optional<std::uint64_t> value = found->whole();
  if (!value) fail(source_, "expected a whole number for " + quote(key));
  return *value;
}

bool GltfFile::numbers(const Json& object, std::string_view key, double* out, std::size_t count) const {
  const Json* found = object.find(key);
  if (found == nullptr) return false;
  if (found->items.size() != count) fail(source_, "expected " + std::to_string(count) + " numbers in a node's transform");
  for (std::size_t i = 0; i < count; ++i) {
    if (!found->items[i].is_number()) fail(source_, "expected a number in a node's transform");
    out[i] = found->items[i].number;
  }
  return true;
}

GltfFile open_glb(const Source& source) {
  const std::string_view bytes = source.bytes;
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunk = 8;
  if (bytes.size() < kHeader + kChunk) fail(source, "truncated: a GLB file has at least 20 bytes");
  if (load<std::uint32_t>(bytes.data() + 4) != 2)
    fail_at_byte(source, 4, "expected GLB version 2, found " + std::to_string(load<std::uint32_t>(bytes.data() + 4)));
  const auto length = load<std::uint32_t>(bytes.data() + 8);
  if (length != bytes.size())
    fail_at_byte(source, 8,
                 "truncated or damaged: the header gives a size of " + std::to_string(length) + " bytes, the file has " +
                     std::to_string(bytes.size()));
  const auto chunk = [&](std::size_t at, std::string_view type) {
    if (bytes.size() - at < kChunk) fail_at_byte(source, at, "truncated: expected a chunk");
    const auto size = load<std::uint32_t>(bytes.data() + at);
    if (bytes.substr(at + 4, 4) != type)
      fail_at_byte(source, at + 4, "expected a chunk of type " + quote(type) + ", found " + quote(bytes.substr(at + 4, 4)));
    if (size > bytes.size() - at - kChunk)
      fail_at_byte(source, at, "truncated: a chunk of " + std::to_string(size) + " bytes does not fit in the file");
    return bytes.substr(at + kChunk, size);
  };
  const std::string_view text = chunk(kHeader, "JSON");
  const std::size_t next = kHeader + kChunk + (text.size() + 3) / 4 * 4;
  std::string_view binary;
  if (next < bytes.size()) binary = chunk(next, std::string_view("BIN\0", 4));
  return {source, text, binary};
}

}  // namespace g3r::io
