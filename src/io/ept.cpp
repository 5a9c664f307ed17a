// Source: entwine.io, "Entwine Point Tile".
#include "io/ept.h"

#include "base/platform.h"
#include "io/cloud_from_table.h"
#include "io/decimal_steps.h"
#include "io/ept_cells.h"
#include "io/json.h"
#include "io/readers.h"
#include "io/subset.h"
#include "io/table.h"
#include "io/text.h"
#include "io/tiles.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

namespace g3r::io {

namespace {

namespace fs = std::filesystem;

/// A dimension of binary records.
struct Dimension {
  std::string name;
  Type type = Type::kFloat64;
  DecimalSteps steps;
};

struct Ept {
  Source file;  // ept.json, for messages
  fs::path folder;
  bool binary = false;
  std::array<double, 6> bounds{};  // of the octree's cube
  std::vector<Dimension> schema;   // in the order of the records
  std::size_t record = 0;          // bytes
};

Json parse(const Source& source) {
  std::optional<Json> json = parse_json(source.bytes, affordable_values(source.bytes.size()));
  if (!json || !json->is_object()) fail(source, "damaged: no JSON object, or too many values for its size");
  return std::move(*json);
}

std::optional<Type> type_named(std::string_view kind, std::uint64_t size) {
  if (kind == "float" || kind == "floating") return type_of(NumberKind::kFloat, size);
  if (kind == "signed") return type_of(NumberKind::kSigned, size);
  return kind == "unsigned" ? type_of(NumberKind::kUnsigned, size) : std::nullopt;
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
        name == nullptr || kind == nullptr || size == nullptr ? std::nullopt : type_named(kind->text, size->whole().value_or(0));
    if (!type) fail(ept.file, "a dimension of the schema has no name, or a type that is not signed, unsigned or float of 1 to 8 bytes");
    // Red: red, as in other formats
    Dimension dimension{lower_case(name->text), *type, DecimalSteps(number(item, "scale", 1), number(item, "offset", 0))};
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

// Records of the schema.
Cloud read_records(const Ept& ept, const Source& source, std::uint64_t count) {
  if (ept.record == 0 || source.bytes.size() % ept.record != 0 || source.bytes.size() / ept.record != count) {
    fail(source, "truncated or damaged: " + std::to_string(count) + " points of " + std::to_string(ept.record) + " bytes declared, found " +
                     std::to_string(source.bytes.size()) + " bytes");
  }
  const std::shared_ptr<Attributes> table = Attributes::of_points(Attributes::Dialect::kNone);
  Element& points = table->elements.back();
  points.count = count;
  for (const Dimension& dimension : ept.schema) {
    const bool as_it_is = dimension.steps.scale() == 1 && dimension.steps.offset() == 0;
    points.add(dimension.name, as_it_is ? dimension.type : Type::kFloat64);
  }
  const char* from = source.bytes.data();
  for (std::uint64_t i = 0; i < count; ++i) {
    for (std::size_t d = 0; d < ept.schema.size(); ++d) {
      const Dimension& dimension = ept.schema[d];
      const double value = dimension.steps.value(load_as_double(dimension.type, from));
      from += size_of(dimension.type);
      append_double(points.properties[d].type, value, points.data);
    }
  }
  Cloud cloud;
  cloud.format = "records";
  fill_cloud(source, table, cloud);
  return cloud;
}

std::string file_of(const Ept& ept, const EptCell& node) {
  return platform::name_of(ept.folder / "ept-data" / (node.name() + (ept.binary ? ".bin" : ".laz")));
}

Cloud read_node(const Ept& ept, const EptCell& node, std::string& path) {
  path = file_of(ept, node);
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

std::vector<std::string> ept_files(const std::string& path) {
  const std::string bytes = read_bytes(path);
  const Ept ept = read_description(path, bytes);
  if (ept.binary) return {path};
  std::vector<std::string> files;
  for (const EptCell& cell : find_ept_cells(ept.folder, ept.bounds, {})) files.push_back(file_of(ept, cell));
  if (files.empty()) fail(ept.file, "no points");
  return files;
}

Cloud read_ept(const std::string& path, const ReadOptions& options) {
  const std::string bytes = read_bytes(path);
  const Ept ept = read_description(path, bytes);
  const std::vector<EptCell> nodes = find_ept_cells(ept.folder, ept.bounds, options);
  std::vector<Cloud> clouds;
  std::vector<std::string> names;
  for (const EptCell& node : nodes) {
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
