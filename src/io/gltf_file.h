// A glTF 2.0 file, binary (GLB) or text with embedded buffers: its JSON, read with checks, and its buffers. No other file is opened.
#pragma once

#include "io/json.h"
#include "io/source.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

/// All members throw InvalidInput.
class GltfFile {
 public:
  /// `text`: the JSON; `binary`: the chunk beside it, of a GLB file. `source` must outlive this.
  GltfFile(const Source& source, std::string_view text, std::optional<std::string_view> binary);

  [[nodiscard]] const Source& source() const { return source_; }
  [[nodiscard]] bool is_binary() const { return binary_.has_value(); }
  [[nodiscard]] const Json& root() const { return root_; }
  /// A top-level array, empty if absent.
  [[nodiscard]] const std::vector<Json>& list(std::string_view key) const;
  [[nodiscard]] const Json& member(const Json& object, std::string_view key) const;
  /// The value as an index below `size`; `what` it is the index of, for messages.
  [[nodiscard]] std::size_t index(const Json& value, std::size_t size, const char* what) const;
  [[nodiscard]] const Json& item(const std::vector<Json>& array, const Json& value, const char* what) const;
  [[nodiscard]] std::uint64_t whole(const Json& object, std::string_view key, std::uint64_t otherwise) const;
  /// Reads an array of numbers into `out`; false if there is none.
  bool numbers(const Json& object, std::string_view key, double* out, std::size_t count) const;
  /// The bytes of the buffer with this index.
  [[nodiscard]] std::string_view buffer(const Json& value) const { return buffers_[index(value, buffers_.size(), "buffer")]; }

 private:
  void load_buffers();

  const Source& source_;
  std::optional<std::string_view> binary_;
  Json root_;
  std::deque<std::string> decoded_;  // stay where they are when this is moved
  std::vector<std::string_view> buffers_;
};

/// The file in the two chunks of a GLB file. Throws InvalidInput.
GltfFile open_glb(const Source& source);

}  // namespace g3r::io
