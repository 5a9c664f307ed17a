// PLY out: binary little-endian, or ascii. Points keep every element, property, list, comment and obj_info of the PLY they came from.
#include "io/ply_header.h"
#include "io/ply_types.h"
#include "io/writers.h"

#include <algorithm>
#include <limits>

namespace g3r::io {

namespace {

// A name that a header can hold: no blanks or control characters, not empty.
std::string header_name(const std::string& name) {
  std::string safe = name;
  for (char& c : safe) {
    if (static_cast<unsigned char>(c) <= ' ' || c == 0x7F) c = '_';
  }
  return safe.empty() ? "unnamed" : safe;
}

Type ply_type(Type type) { return type == Type::kInt64 || type == Type::kUint64 ? Type::kFloat64 : type; }

void append_property(const Property& property, std::string& header) {
  const auto line = [&](const std::string& name) {
    header += "property ";
    if (property.list) header += std::string("list ") + ply_type_name(property.count_type) + " ";
    header += std::string(ply_type_name(property.type)) + " " + header_name(name) + "\n";
  };
  if (property.count == 1) return line(property.name);
  for (std::uint32_t k = 0; k < property.count; ++k) line((property.name + '_') += std::to_string(k));
}

void write_element(const Element& element, bool ascii, OutputFile& file) {
  if (!ascii) return file.write(element.data);
  std::string text;
  const char* at = element.data.data();
  for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i) {
    text.clear();
    for (const Property& property : element.properties) at = append_property_as_text(property, at, text);
    text.back() = '\n';
    file.write(text);
  }
}

void append_format(bool ascii, std::string& header) {
  header += ascii ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_little_endian 1.0\n";
}

}  // namespace

std::vector<Column> ply_columns(const PointData& data) {
  std::vector<Column> columns = plan_columns(data, Attributes::Dialect::kPly, true);
  for (Column& column : columns) column.property.type = ply_type(column.property.type);
  return columns;
}

std::string ply_header(const std::vector<std::string>& comments, std::uint64_t points, const std::vector<Column>& columns) {
  std::string header;
  append_format(false, header);
  for (const std::string& comment : comments) header += comment + "\n";
  header += "element vertex " + std::to_string(points) + "\n";
  for (const Column& column : columns) append_property(column.property, header);
  return header + "end_header\n";
}

void write_ply(const PointData& data, OutputFile& file) {
  const std::vector<Column> columns = ply_columns(data);
  const bool ascii = data.options.ascii;
  const bool from_ply = data.table != nullptr && data.table->dialect == Attributes::Dialect::kPly;
  std::string header;
  append_format(ascii, header);
  if (from_ply) {
    for (const std::string& comment : data.table->comments) header += comment + "\n";
  }
  const std::size_t elements = from_ply ? data.table->elements.size() : 1;
  const std::size_t vertex = from_ply ? data.table->vertex : 0;
  for (std::size_t e = 0; e < elements; ++e) {
    if (e == vertex) {
      header += "element vertex " + std::to_string(data.size()) + "\n";
      for (const Column& column : columns) append_property(column.property, header);
    } else {
      const Element& element = data.table->elements[e];
      header += "element " + header_name(element.name) + " " + std::to_string(element.count) + "\n";
      for (const Property& property : element.properties) append_property(property, header);
    }
  }
  file.write(header + "end_header\n");
  for (std::size_t e = 0; e < elements; ++e) {
    if (e == vertex) {
      write_rows(data, columns, file);
    } else {
      write_element(data.table->elements[e], ascii, file);
    }
  }
}

void write_ply_mesh(const Mesh& mesh, bool ascii, OutputFile& file) {
  const bool wide = mesh.vertices.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  Property list;
  list.name = "vertex_indices";
  list.type = wide ? Type::kUint32 : Type::kInt32;
  list.list = true;
  Cloud cloud;  // the vertices are written as points are
  cloud.positions = mesh.vertices;
  cloud.colors = mesh.colors;
  cloud.confidence = mesh.confidence;
  const WriteOptions options{.ascii = ascii};
  const PointData data = check_points(cloud, nullptr, nullptr, options);
  const std::vector<Column> columns = plan_columns(data, Attributes::Dialect::kPly, true);
  std::string header;
  append_format(ascii, header);
  header += "element vertex " + std::to_string(mesh.vertices.size()) + "\n";
  for (const Column& column : columns) append_property(column.property, header);
  header += "element face " + std::to_string(mesh.triangles.size()) + "\n";
  append_property(list, header);
  file.write(header + "end_header\n");
  write_rows(data, columns, file);
  std::string text;
  for (const auto& triangle : mesh.triangles) {
    char record[13] = {3};
    std::memcpy(record + 1, triangle.data(), 12);
    if (!ascii) {
      file.write(record, sizeof record);
      continue;
    }
    text.clear();
    append_property_as_text(list, record, text);
    text.back() = '\n';
    file.write(text);
  }
}

}  // namespace g3r::io
