// A folder for the files of a test, and files as bytes.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

namespace g3r {

/// Makes a folder of a name that no other has. Its path has slashes only.
inline std::string make_temporary_folder() {
  std::random_device number;
  for (;;) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() / ("g3r-test-" + std::to_string(number()));
    if (std::filesystem::create_directory(path)) return path.generic_string();
  }
}

/// Made anew, and gone with all it holds at the end of the scope.
class TemporaryFolder {
 public:
  TemporaryFolder() = default;
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_ = make_temporary_folder();
};

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

}  // namespace g3r
