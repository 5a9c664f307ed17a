// Counts in the JSON of work folders.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>

namespace g3r::tiles {

/// A count. Throws json::exception for everything else: the library's own conversion takes fractions, and of what is too large any number.
[[nodiscard]] inline std::uint64_t whole_number(const nlohmann::json& value) {
  return value.get_ref<const nlohmann::json::number_unsigned_t&>();
}

}  // namespace g3r::tiles
