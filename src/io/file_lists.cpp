// Source: STAC 1.0, and "Virtual Point Clouds (VPC)", github.com/PDAL/wrench.
#include "io/file_lists.h"

#include "base/platform.h"
#include "io/source.h"
#include "io/text.h"

#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace g3r::io {

namespace {

using nlohmann::json;

// Names on one list. More is no list; a line of two bytes takes a hundred here, its folder included.
constexpr std::size_t kMostFiles = 1000000;
constexpr int kDeepest = 64;  // nesting of a virtual point cloud, which has 10; each level takes memory for a byte

std::string located(const Source& source, const std::string& name) {
  if (name.find("://") != std::string::npos) fail(source, "names " + quote(name) + ", which is not on this machine: get the files first");
  const std::filesystem::path path = (platform::path_of(source.name).parent_path() / platform::path_of(name)).lexically_normal();
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
    fail(source, "names " + quote(name) + ", which is no file: expected files of points");
  return path == "-" ? "./-" : platform::name_of(path);  // the name alone is standard input
}

void add(const Source& source, const std::string& name, std::vector<std::string>& files) {
  if (files.size() == kMostFiles) fail(source, "names more than " + std::to_string(kMostFiles) + " files");
  files.push_back(located(source, name));
}

std::vector<std::string> of_list(const Source& source) {
  std::vector<std::string> files;
  Lines lines(source.bytes);
  std::string_view line;
  while (lines.next_filled(line)) {
    line = trim(line);
    if (line[0] != '#') add(source, std::string(line), files);
  }
  return files;
}

// Features are taken as they are read and dropped, of each no more than the way to its file: memory is that of the names.
std::vector<std::string> of_vpc(const Source& source) {
  std::vector<std::string> files;
  bool inside = false;  // the list of features
  bool any = false;
  const auto require = [&](bool holds) {
    if (!holds) fail(source, "feature " + std::to_string(files.size() + 1) + ": expected the path of a file as assets.data.href");
  };
  const auto on_the_way = [&](int depth, json::parse_event_t event, const json& value) {
    using Event = json::parse_event_t;
    if (depth > kDeepest) fail(source, "nested deeper than a FeatureCollection");
    constexpr std::array<std::string_view, 6> kWay = {"", "features", "", "assets", "data", "href"};  // keys at each depth
    if (event == Event::key) {
      const bool follows =
          depth < static_cast<int>(kWay.size()) && value.get_ref<const std::string&>() == kWay[static_cast<std::size_t>(depth)];
      if (depth == 1) inside = follows;
      return follows;
    }
    if (event == Event::array_start && depth == 1 && inside) any = true;
    if (inside && depth == 2) require(event == Event::object_start || event == Event::object_end);
    if (event == Event::object_end && inside && depth == 2) {
      const json href = value.value(json::json_pointer("/assets/data/href"), json());
      require(href.is_string());
      add(source, href.get<std::string>(), files);
      return false;
    }
    if (event == Event::array_start || event == Event::array_end) return depth == 1;
    return event == Event::value ? depth == 5 && value.is_string() : depth < 5;
  };
  try {
    any = json::parse(source.bytes, on_the_way).is_object() && any;
  } catch (const json::exception&) {
    any = false;
  }
  if (!any) fail(source, "expected a FeatureCollection in JSON with a list of features");
  return files;
}

}  // namespace

bool is_file_list(const std::string& path) {
  const std::string ext = extension(path);
  return ext == "list" || ext == "vpc";
}

std::vector<std::string> files_of_list(const std::string& path) {
  const std::string bytes = read_bytes(path);
  const Source source{bytes, path};
  std::vector<std::string> files = extension(path) == "vpc" ? of_vpc(source) : of_list(source);
  if (files.empty()) fail(source, "names no files");
  return files;
}

}  // namespace g3r::io
