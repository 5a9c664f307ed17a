// PCD 0.7 out: binary, or ascii. A cloud read from PCD keeps its fields, their types and arrays, WIDTH, HEIGHT and VIEWPOINT; padding is
// dropped. As text packed colours are whole numbers, as PCL writes them: as floats many of them are no numbers.
#include "io/text_numbers.h"
#include "io/writers.h"

#include <algorithm>

namespace g3r::io {

namespace {

char type_letter(Type type) {
  if (is_float(type)) return 'F';
  return type == Type::kInt8 || type == Type::kInt16 || type == Type::kInt32 || type == Type::kInt64 ? 'I' : 'U';
}

std::string header_line(const char* keyword, const std::vector<Column>& columns, const auto& value) {
  std::string line = keyword;
  for (const Column& column : columns) (line += ' ') += value(column.property);
  return line += '\n';
}

std::string header(const PointData& data, const std::vector<Column>& columns) {
  std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
  const bool from_pcd = data.table != nullptr && data.table->dialect == Attributes::Dialect::kPcd;
  std::string width = "WIDTH " + std::to_string(data.size()) + "\n";
  std::string height = "HEIGHT 1\n";
  std::string viewpoint = "VIEWPOINT 0 0 0 1 0 0 0\n";
  if (!from_pcd && data.cloud.sensor_positions.size() == 1) {
    viewpoint = "VIEWPOINT";
    for (const double coordinate : data.cloud.sensor_positions[0]) append_number(viewpoint += ' ', coordinate);
    viewpoint += " 1 0 0 0\n";
  }
  if (from_pcd) {
    for (const std::string& line : data.table->comments) {
      std::string& place = line.starts_with("WIDTH")       ? width
                           : line.starts_with("HEIGHT")    ? height
                           : line.starts_with("VIEWPOINT") ? viewpoint
                                                           : text;
      place = (&place == &text ? text : std::string()) + line + '\n';
    }
  }
  text += "VERSION 0.7\n";
  text += header_line("FIELDS", columns, [](const Property& p) {
    std::string name = p.name;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) <= ' '; }, '_');
    return name;
  });
  text += header_line("SIZE", columns, [](const Property& p) { return std::to_string(size_of(p.type)); });
  text += header_line("TYPE", columns, [](const Property& p) { return std::string(1, type_letter(p.type)); });
  text += header_line("COUNT", columns, [](const Property& p) { return std::to_string(p.count); });
  text += width + height + viewpoint + "POINTS " + std::to_string(data.size()) + '\n';
  return text + (data.options.ascii ? "DATA ascii\n" : "DATA binary\n");
}

}  // namespace

void write_pcd(const PointData& data, OutputFile& file) {
  std::vector<Column> columns = plan_columns(data, Attributes::Dialect::kPcd, false);
  for (Column& column : columns) {
    const Property& property = column.property;
    const bool packed = (property.name == "rgb" || property.name == "rgba") && property.type == Type::kFloat32 && property.count == 1;
    if (!packed || !data.options.ascii) continue;
    column.property.type = Type::kUint32;
    if (column.from == Column::From::kTable) column.from = Column::From::kTableBits;
  }
  file.write(header(data, columns));
  write_rows(data, columns, file);
}

}  // namespace g3r::io
