// A JSON tree for the headers of untrusted files: views into the text, bounded in size and depth, no allocation on the way down.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace g3r::io {

/// A value; the text must outlive it. Strings are kept as they stand in the text, escapes and all.
struct Json {
  enum class Kind : std::uint8_t { kNull, kBool, kNumber, kString, kArray, kObject };
  Kind kind = Kind::kNull;
  double number = 0;
  std::string_view text;
  std::vector<Json> items;             ///< of an array, or the values of an object
  std::vector<std::string_view> keys;  ///< of an object, in order

  [[nodiscard]] bool is_array() const { return kind == Kind::kArray; }
  [[nodiscard]] bool is_object() const { return kind == Kind::kObject; }
  [[nodiscard]] bool is_number() const { return kind == Kind::kNumber; }
  /// The number if it is whole and within 0..2^53.
  [[nodiscard]] std::optional<std::uint64_t> whole() const;
  /// The value of a key of an object, null if there is none.
  [[nodiscard]] const Json* find(std::string_view key) const;
};

/// The most values that a file of so many bytes may have under the memory law: a value takes 96 bytes, twice or thrice that while its array
/// grows, and 2000 values fit into what is allowed beside the size of the file.
[[nodiscard]] inline std::size_t affordable_values(std::size_t bytes) { return bytes / 30 + 2000; }

/// Parses a text; nullopt if it is not well formed, deeper than 64 levels, or has more than `most_values` values.
std::optional<Json> parse_json(std::string_view text, std::size_t most_values);

}  // namespace g3r::io
