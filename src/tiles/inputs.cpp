#include "tiles/inputs.h"

#include "base/platform.h"
#include "io/ept.h"
#include "io/tiles.h"
#include "tiles/manifest.h"
#include "tiles/point_hash.h"

#include <filesystem>
#include <system_error>

namespace g3r::tiles {
namespace {

constexpr std::uint64_t kAnyNumber = std::uint64_t{1} << 48U;  // of points, in files of unknown size

}  // namespace

std::vector<std::string> found_files(const std::vector<std::string>& inputs) {
  std::vector<std::string> files;
  for (const std::string& input : inputs) {
    const std::string ept = io::find_ept(input);
    const std::vector<std::string> found = ept.empty() ? io::find_tiles(input) : io::ept_files(ept);
    if (found.empty()) files.push_back(input);
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

std::vector<std::string> files_of(const std::vector<std::string>& inputs) {
  std::vector<std::string> files = found_files(inputs);
  if (files.empty()) throw InvalidInput("plan_tiles: no input");
  for (std::string& file : files) {
    if (!can_be_stored(file)) throw InvalidInput(escape_text(file) + ": tiles expect names of files in UTF-8; rename it");
    file = platform::name_of(std::filesystem::absolute(platform::path_of(file)));
  }
  return files;
}

std::uint64_t most_points(const std::vector<std::string>& files) {
  std::uint64_t bytes = 0;
  for (const std::string& file : files) {
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(platform::path_of(file), error);
    if (error || size > kAnyNumber - bytes) return kAnyNumber;
    bytes += size;
  }
  return bytes;
}

std::vector<std::uint64_t> hashes_of(const std::vector<std::string>& files, int threads, Stages& stages) {
  std::vector<std::uint64_t> hashes(files.size());
  for_all_points(
      files, {.threads = threads, .cancel = stages.cancel()}, [](std::size_t, const io::PointStream&) {},
      [&](double share) { stages.progress(share); }, [&](std::size_t file, const Vec3& p) { hashes[file] = point_hash(hashes[file], p); });
  return hashes;
}

}  // namespace g3r::tiles
