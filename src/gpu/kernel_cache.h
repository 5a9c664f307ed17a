// Compiled kernels, kept in the user's cache folder: $XDG_CACHE_HOME/g3r or ~/.cache/g3r, kernels-KEY. Internal to src/gpu.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::gpu {

/// The place of one compilation. `everything`: all that the result depends on: device, driver, options, source. A cache that cannot be read
/// or written is none: no function throws.
class KernelCache {
 public:
  explicit KernelCache(std::string_view everything);
  /// Keeps nothing.
  KernelCache() = default;

  /// What was written for the same key; empty if there is nothing, or it is damaged.
  [[nodiscard]] std::vector<unsigned char> read() const;
  /// Whole or not at all, whoever else writes it.
  void write(const std::vector<unsigned char>& binary) const;
  /// Empty without a cache folder.
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::string key_;
  std::filesystem::path file_;
};

/// The first line of a compiler's log that complains, or else `otherwise`.
[[nodiscard]] std::string first_complaint(std::string_view log, std::string_view otherwise);

}  // namespace g3r::gpu
