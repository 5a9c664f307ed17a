// Source: STAC 1.0, and "Virtual Point Clouds (VPC)", github.com/PDAL/wrench.
#include "io/file_lists.h"

#include "io/json.h"
#include "io/source.h"
#include "io/text.h"

#include <filesystem>
#include <optional>

namespace g3r::io {

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 28;   // of a list: a million files; more is no list
constexpr std::size_t kMostValues = std::size_t{1} << 24;  // of its JSON

// A string as it stands in JSON, without its escapes; nothing for those that no path needs.
std::optional<std::string> unescaped(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\') {
      if (++i == text.size() || (text[i] != '/' && text[i] != '\\' && text[i] != '"')) return std::nullopt;
    }
    plain += text[i];
  }
  return plain;
}

std::string located(const Source& source, const std::string& name) {
  if (name.find("://") != std::string::npos) fail(source, "names " + quote(name) + ", which is not on this machine: get the files first");
  const std::filesystem::path path(name);
  return path.is_absolute() ? name : (std::filesystem::path(source.name).parent_path() / path).lexically_normal().string();
}

std::vector<std::string> of_list(const Source& source) {
  std::vector<std::string> files;
  Lines lines(source.bytes);
  std::string_view line;
  while (lines.next_filled(line)) {
    line = trim(line);
    if (line[0] != '#') files.push_back(located(source, std::string(line)));
  }
  return files;
}

std::vector<std::string> of_vpc(const Source& source) {
  const std::optional<Json> root = parse_json(source.bytes, kMostValues);
  const Json* features = root ? root->find("features") : nullptr;
  if (features == nullptr || !features->is_array()) fail(source, "expected a FeatureCollection in JSON with a list of features");
  std::vector<std::string> files;
  for (const Json& feature : features->items) {
    const Json* assets = feature.find("assets");
    const Json* data = assets != nullptr ? assets->find("data") : nullptr;
    const Json* href = data != nullptr ? data->find("href") : nullptr;
    const std::optional<std::string> name =
        href != nullptr && href->kind == Json::Kind::kString ? unescaped(href->text) : std::optional<std::string>();
    if (!name) fail(source, "feature " + std::to_string(files.size() + 1) + ": expected the path of a file as assets.data.href");
    files.push_back(located(source, *name));
  }
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
  if (bytes.size() > kMostBytes) fail(source, "too long for a list of files");
  std::vector<std::string> files = extension(path) == "vpc" ? of_vpc(source) : of_list(source);
  if (files.empty()) fail(source, "names no files");
  return files;
}

}  // namespace g3r::io
