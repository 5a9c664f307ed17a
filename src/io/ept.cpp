// Source: entwine.io, "Entwine Point Tile".
#include "io/ept.h"

#include "base/platform.h"
#include "io/cloud_from_table.h"
#include "io/json.h"
#include "io/readers.h"
#include "io/subset.h"
#include "io/table.h"
#include "io/text.h"
#include "io/tiles.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

namespace g3r::io {

namespace {

namespace fs = std::filesystem;

using Key = std::array<std::uint32_t, 4>;  // level, x, y, z

// The deepest level: cells of 2^-31 of the cube are smaller than the steps of its coordinates, so what names deeper ones is damaged.
constexpr std::uint32_t kDeepest = 31;

/// A dimension of binary records.
struct Dimension {
  std::string name;
  Type type = Type::kFloat64;
  double scale = 1;
  double offset = 0;
};

struct Ept {
  Source file;  // ept.json, for messages
  fs::path folder;
  bool binary = false;
  std::array<double, 6> bounds{};  // of the octree's cube
  std::vector<Dimension> schema;   // in the order of the records
  std::size_t record = 0;          // bytes
};

struct Node {
  Key key;
  std::uint64_t points;
};

std::string name_of(const Key& key) {
  std::string name = std::to_string(key[0]);
  for (std::size_t i = 1; i < key.size(); ++i) (name += '-') += std::to_string(key[i]);
  return name;
}

// "3-1-0-7"; each place lies within its level.
std::optional<Key> parse_key(std::string_view text) {
  Key key{};
  for (std::size_t i = 0; i < key.size(); ++i) {
    const std::size_t end = i + 1 < key.size() ? text.find('-') : text.size();
    if (end == std::string_view::npos || !parse_integer(text.substr(0, end), key[i])) return std::nullopt;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (key[0] > kDeepest) return std::nullopt;
  for (std::size_t i = 1; i < key.size(); ++i) {
    if (std::uint64_t{key[i]} >> key[0] != 0) return std::nullopt;
  }
  return key;
}

Json parse(const Source& source) {
  std::optional<Json> json = parse_json(source.bytes, affordable_values(source.bytes.size()));
  if (!json || !json->is_object()) fail(source, "damaged: no JSON object, or too many values for its size");
  return std::move(*json);
}

std::optional<Type> type_of(std::string_view kind, std::uint64_t size) {
  if (kind == "float" || kind == "floating")
    return size == 4 ? std::optional(Type::kFloat32) : size == 8 ? std::optional(Type::kFloat64) : std::nullopt;
  const bool negative = kind == "signed";
  if (!negative && kind != "unsigned") return std::nullopt;
  switch (size) {
    case 1:
      return negative ? Type::kInt8 : Type::kUint8;
    case 2:
      return negative ? Type::kInt16 : Type::kUint16;
    case 4:
      return negative ? Type::kInt32 : Type::kUint32;
    case 8:
      return negative ? Type::kInt64 : Type::kUint64;
    default:
      return std::nullopt;
  }
}

void read_schema(const Json& json, Ept& ept) {
  const Json* schema = json.find("schema");
  if (schema == nullptr || !schema->is_array()) fail(ept.file, "no schema: expected an array of dimensions");
  const auto number = [](const Json& item, const char* key, double otherwise) {
    const Json* value = item.find(key);
    return value != nullptr && value->is_number() && std::isfinite(value->number) ? value->number : otherwise;
  };
  for (const Json& item : schema->items) {
    const Json* name = item.find("name");
    const Json* kind = item.find("type");
    const Json* size = item.find("size");
    const std::optional<Type> type =
        name == nullptr || kind == nullptr || size == nullptr ? std::nullopt : type_of(kind->text, size->whole().value_or(0));
    if (!type) fail(ept.file, "a dimension of the schema has no name, or a type that is not signed, unsigned or float of 1 to 8 bytes");
    Dimension dimension{std::string(name->text), *type, number(item, "scale", 1), number(item, "offset", 0)};
    for (char& c : dimension.name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;  // Red: red, as in other formats
    for (const Dimension& other : ept.schema) {
      if (other.name == dimension.name) fail(ept.file, "the dimension " + quote(dimension.name) + " is declared twice");
    }
    ept.record += size_of(dimension.type);
    ept.schema.push_back(std::move(dimension));
  }
}

Ept read_description(const std::string& path, const std::string& bytes) {
  Ept ept;
  ept.file = {bytes, path};
  ept.folder = platform::path_of(path).parent_path();
  const Json json = parse(ept.file);
  const Json* data = json.find("dataType");
  if (data == nullptr || (data->text != "laszip" && data->text != "binary")) {
    fail(ept.file, "expected the dataType laszip or binary, found " + (data == nullptr ? "none" : quote(data->text)) +
                       "; build the tiles anew, for example with \"untwine\" or \"entwine build\"");
  }
  ept.binary = data->text == "binary";
  const Json* bounds = json.find("bounds");
  bool sound = bounds != nullptr && bounds->is_array() && bounds->items.size() == ept.bounds.size();
  for (std::size_t i = 0; sound && i < ept.bounds.size(); ++i) {
    ept.bounds[i] = bounds->items[i].number;
    sound = bounds->items[i].is_number() && std::isfinite(ept.bounds[i]) && (i < 3 || ept.bounds[i - 3] <= ept.bounds[i]);
  }
  if (!sound) fail(ept.file, "expected bounds of six numbers, the low corner first");
  if (ept.binary) read_schema(json, ept);
  return ept;
}

// The cells that have points, of the levels and the box that are asked for.
class Hierarchy {
 public:
  Hierarchy(const Ept& ept, const ReadOptions& options) : ept_(ept), options_(options) {}

  std::vector<Node> read() {
    pages_.push_back({});
    while (!pages_.empty()) {
      const Key page = pages_.back();
      pages_.pop_back();
      if (seen_.insert(page).second) read_page(page);
    }
    std::sort(nodes_.begin(), nodes_.end(), [](const Node& a, const Node& b) { return a.key < b.key; });
    const auto same = [](const Node& a, const Node& b) { return a.key == b.key; };
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end(), same), nodes_.end());
    return std::move(nodes_);
  }

 private:
  // Entries are taken as they are read, without a tree of them.
  void read_page(const Key& page) {
    const std::string path = platform::name_of(ept_.folder / "ept-hierarchy" / (name_of(page) + ".json"));
    const std::string bytes = read_bytes(path);
    const Source source{bytes, path};
    const auto damaged = [&] { fail(source, "damaged: no JSON object of cells"); };
    std::string cell;
    const auto take = [&](int depth, nlohmann::json::parse_event_t event, const nlohmann::json& value) {
      using Event = nlohmann::json::parse_event_t;
      if (event == Event::key) {
        cell = value.get<std::string>();
      } else if (event == Event::value || depth > 0) {
        read_entry(source, cell, depth == 1 ? value : nlohmann::json());
      }
      return depth == 0;  // nothing is kept
    };
    try {
      if (!nlohmann::json::parse(source.bytes, take).is_object()) damaged();
    } catch (const nlohmann::json::exception&) {
      damaged();
    }
  }

  void read_entry(const Source& source, const std::string& cell, const nlohmann::json& points) {
    const std::optional<Key> key = parse_key(cell);
    const bool refers = points == -1;
    if (!key || !(refers || points.is_number_unsigned())) fail(source, "expected cells such as \"2-0-1-3\": 1000, found " + quote(cell));
    if (options_.levels != 0 && (*key)[0] >= static_cast<std::uint32_t>(options_.levels)) return;
    if (!meets_box(*key)) return;
    if (refers) {
      pages_.push_back(*key);
    } else if (points != 0) {
      nodes_.push_back({*key, points.get<std::uint64_t>()});
    }
  }

  [[nodiscard]] bool meets_box(const Key& key) const {
    for (std::size_t a = 0; options_.box && a < 3; ++a) {
      const double side = std::ldexp(ept_.bounds[3 + a] - ept_.bounds[a], -static_cast<int>(key[0]));
      const double low = ept_.bounds[a] + side * key[a + 1];
      const double slack = 1e-6 * side;  // points on the side of a cell may lie in either
      if (low - slack > options_.box->high[a] || low + side + slack < options_.box->low[a]) return false;
    }
    return true;
  }

  const Ept& ept_;
  const ReadOptions& options_;
  std::vector<Key> pages_;
  std::set<Key> seen_;
  std::vector<Node> nodes_;
};

// Records of the schema.
Cloud read_records(const Ept& ept, const Source& source, std::uint64_t count) {
  if (ept.record == 0 || source.bytes.size() % ept.record != 0 || source.bytes.size() / ept.record != count) {
    fail(source, "truncated or damaged: " + std::to_string(count) + " points of " + std::to_string(ept.record) + " bytes declared, found " +
                     std::to_string(source.bytes.size()) + " bytes");
  }
  const std::shared_ptr<Attributes> table = Attributes::of_points(Attributes::Dialect::kPly);
  Element& points = table->elements.back();
  points.count = count;
  for (const Dimension& dimension : ept.schema) {
    points.properties.emplace_back();
    points.properties.back().name = dimension.name;
    const bool as_it_is = dimension.scale == 1 && dimension.offset == 0;
    points.properties.back().type = as_it_is ? dimension.type : Type::kFloat64;
  }
  const char* from = source.bytes.data();
  for (std::uint64_t i = 0; i < count; ++i) {
    for (std::size_t d = 0; d < ept.schema.size(); ++d) {
      const Dimension& dimension = ept.schema[d];
      const double value = load_as_double(dimension.type, from) * dimension.scale + dimension.offset;
      from += size_of(dimension.type);
      char stored[8];
      store_double(points.properties[d].type, value, stored);
      points.data.append(stored, size_of(points.properties[d].type));
    }
  }
  Cloud cloud;
  cloud.format = "records";
  fill_cloud(source, table, cloud);
  return cloud;
}

Cloud read_node(const Ept& ept, const Node& node, std::string& path) {
  path = platform::name_of(ept.folder / "ept-data" / (name_of(node.key) + (ept.binary ? ".bin" : ".laz")));
  const std::string bytes = read_bytes(path);
  const Source source{bytes, path};
  if (ept.binary) return read_records(ept, source, node.points);
  if (bytes.substr(0, 4) != "LASF") fail(source, "expected the LAS magic \"LASF\", found " + quote(bytes.substr(0, 4)));
  Cloud cloud = read_las(source, {});
  if (cloud.positions.size() != node.points) {
    fail(source,
         "damaged: the hierarchy declares " + std::to_string(node.points) + " points, found " + std::to_string(cloud.positions.size()));
  }
  return cloud;
}

}  // namespace

std::string find_ept(const std::string& path) {
  std::error_code ignored;
  const fs::path there = platform::path_of(path);
  const fs::path file = fs::is_directory(there, ignored) ? there / "ept.json" : there;
  return file.filename() == "ept.json" && fs::is_regular_file(file, ignored) ? platform::name_of(file) : "";
}

Cloud read_ept(const std::string& path, const ReadOptions& options) {
  const std::string bytes = read_bytes(path);
  const Ept ept = read_description(path, bytes);
  const std::vector<Node> nodes = Hierarchy(ept, options).read();
  std::vector<Cloud> clouds;
  std::vector<std::string> names;
  for (const Node& node : nodes) {
    std::string name;
    Cloud cloud = read_node(ept, node, name);
    if (options.box) keep_box(cloud, *options.box);
    if (cloud.positions.empty()) continue;
    forget_las(cloud);
    clouds.push_back(std::move(cloud));
    names.push_back(std::move(name));
  }
  if (clouds.empty()) fail(ept.file, options.box ? "no points within the box" : "no points");
  const std::string format = "ept, " + std::to_string(clouds.size()) + (ept.binary ? " cells of records" : " cells of LAZ");
  Cloud cloud = merge_clouds(clouds, names, path);
  cloud.format = format;
  return cloud;
}

}  // namespace g3r::io
