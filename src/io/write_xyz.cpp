// Text with one point per line. Columns that a reader could not name by itself get a header: names behind "//" (XYZ, TXT), as a first line
// (CSV).
#include "io/writers.h"

namespace g3r::io {

void write_xyz(const PointData& data, char separator, bool counted, OutputFile& file) {
  const std::vector<Column> columns = plan_columns(data, Attributes::Dialect::kText, false);
  std::string line;
  const auto end_line = [&] {
    line.back() = '\n';
    file.write(line);
    line.clear();
  };
  if (counted) {
    line = std::to_string(data.size()) + " ";
    end_line();
  } else if (separator == ',' || columns.size() > 3) {
    line = separator == ',' ? "" : "//";
    for (const Column& column : columns) {
      for (std::uint32_t k = 0; k < column.property.count; ++k) {
        for (const char c : column.property.name) line += static_cast<unsigned char>(c) <= ' ' || c == ',' || c == ';' ? '_' : c;
        if (column.property.count > 1) (line += '_') += std::to_string(k);
        line += separator;
      }
    }
    end_line();
  }
  Rows rows(data, columns);
  std::string bytes;
  for (std::size_t i = 0; i < data.size(); ++i) {
    rows.next();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Property& property = columns[c].property;
      bytes.clear();
      rows.append_bytes(c, bytes);
      for (std::uint32_t k = 0; k < property.count; ++k) {
        append_as_text(property.type, bytes.data() + k * size_of(property.type), line);
        line += separator;
      }
    }
    end_line();
  }
}

}  // namespace g3r::io
