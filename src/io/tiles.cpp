#include "io/tiles.h"

#include "base/platform.h"
#include "io/cloud_from_table.h"
#include "io/file_lists.h"
#include "io/merger.h"
#include "io/table.h"

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

namespace g3r::io {

namespace {

namespace fs = std::filesystem;

// No .txt and .obj: folders hold texts that are no points, and meshes.
constexpr std::array<std::string_view, 12> kExtensions = {"las", "laz", "ply", "pcd", "e57", "ptx",
                                                          "pts", "xyz", "csv", "asc", "npy", "spz"};

constexpr std::size_t kMostWarnings = 8;  // All files together give so many: a thousand with the same oddity would hide what is said else.

std::vector<std::string> files_of_folder(const std::string& path) {
  std::vector<std::string> files;
  std::error_code error;
  fs::directory_iterator entry(platform::path_of(path), error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = platform::name_of(entry->path());
    std::error_code ignored;
    const bool points = std::find(kExtensions.begin(), kExtensions.end(), extension(name)) != kExtensions.end();
    if (points && entry->is_regular_file(ignored)) files.push_back(name);
  }
  if (error) throw IoError(IoError::Kind::kNotFound, escape_text(path) + ": " + error.message());
  if (files.empty())
    throw IoError(
        IoError::Kind::kNotFound,
        escape_text(path) + ": a folder without files of points (.las, .laz, .ply, .pcd, .e57, .ptx, .pts, .xyz, .csv, .asc, .npy, .spz)");
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> files_of_pattern(const std::string& path) {
  std::vector<std::string> files = platform::matching(path);
  std::erase_if(files, [](const std::string& file) {
    std::error_code ignored;
    return !fs::is_regular_file(platform::path_of(file), ignored);
  });
  if (files.empty()) throw IoError(IoError::Kind::kNotFound, escape_text(path) + ": no file has such a name");
  std::sort(files.begin(), files.end());
  return files;
}

// The colours in the tables of clouds, measured; nothing of clouds whose table has none, or only black.
std::deque<std::optional<RecordColors>> colors_of(const std::vector<Cloud>& clouds) {
  std::deque<std::optional<RecordColors>> all;
  for (const Cloud& cloud : clouds) {
    std::optional<RecordColors>& colors = all.emplace_back();
    if (cloud.colors.empty() || cloud.attributes == nullptr) continue;
    const Element& points = cloud.attributes->points();
    colors.emplace(points);
    colors->measure(points.data.data(), points.count);
    if (!colors->exist()) colors.reset();
  }
  return all;
}

void merge_scanners(const std::vector<Cloud>& clouds, Cloud& whole) {
  if (std::any_of(clouds.begin(), clouds.end(), [](const Cloud& c) { return c.sensor_positions.empty(); })) return;
  for (const Cloud& cloud : clouds) {
    const auto first = static_cast<std::uint32_t>(whole.sensor_positions.size());
    whole.sensor_positions.insert(whole.sensor_positions.end(), cloud.sensor_positions.begin(), cloud.sensor_positions.end());
    for (std::size_t i = 0; i < cloud.positions.size(); ++i)
      whole.scan_of_point.push_back(first + (cloud.scan_of_point.empty() ? 0 : cloud.scan_of_point[i]));
  }
  if (whole.sensor_positions.size() == 1) whole.scan_of_point = {};
}

void merge_warnings(const std::vector<Cloud>& clouds, const std::vector<std::string>& names, Cloud& whole) {
  std::size_t more = 0;
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    for (const std::string& warning : clouds[k].warnings) {
      if (whole.warnings.size() < kMostWarnings) {
        whole.warnings.push_back(escape_text(names[k]) + ": " + warning);
      } else {
        ++more;
      }
    }
  }
  if (more != 0) whole.warnings.push_back("and " + std::to_string(more) + " more warnings about these files");
}

}  // namespace

std::vector<std::string> find_tiles(const std::string& path) {
  std::error_code ignored;
  const fs::path there = platform::path_of(path);
  if (fs::is_directory(there, ignored)) return files_of_folder(path);
  if (is_file_list(path) && fs::is_regular_file(there, ignored)) return files_of_list(path);
  if (path.find_first_of("*?") == std::string::npos || fs::exists(there, ignored)) return {};
  return files_of_pattern(path);
}

void forget_las(Cloud& cloud) {
  if (cloud.attributes == nullptr || cloud.attributes->dialect != Attributes::Dialect::kLas) return;
  cloud.attributes = Attributes::of_points(Attributes::Dialect::kNone, cloud.attributes->points());
}

Cloud merge_clouds(std::vector<Cloud>& clouds, const std::vector<std::string>& names, const std::string& path) {
  if (clouds.size() == 1) return std::move(clouds[0]);
  Cloud whole;
  whole.format = std::to_string(clouds.size()) + " files";
  const auto same = [&](const Cloud& cloud) { return cloud.format == clouds[0].format; };
  if (std::all_of(clouds.begin(), clouds.end(), same)) whole.format += " of " + clouds[0].format;
  std::deque<std::optional<RecordColors>> colors = colors_of(clouds);
  std::vector<RecordColors*> all;
  for (std::optional<RecordColors>& of_cloud : colors) {
    if (of_cloud) all.push_back(&*of_cloud);
  }
  Merger merger(clouds, RecordColors::agree(all));
  for (std::size_t i = 0; i < clouds.size(); ++i) merger.append(clouds[i], colors[i] ? &*colors[i] : nullptr);
  std::shared_ptr<Attributes> table = Attributes::of_points(merger.dialect(), merger.take());
  merge_scanners(clouds, whole);
  merge_warnings(clouds, names, whole);
  clouds.clear();
  fill_cloud({{}, path}, std::move(table), whole);
  return whole;
}

}  // namespace g3r::io
