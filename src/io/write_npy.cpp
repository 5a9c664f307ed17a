// NPY out: an N x C array, row major, x y z first, then the normals, then the other columns. double unless every column is float.
#include "io/writers.h"

#include <algorithm>

namespace g3r::io {

void write_npy(const PointData& data, OutputFile& file) {
  std::vector<Column> columns = plan_columns(data, Attributes::Dialect::kText, false);
  const auto rank = [](const Column& column) {
    constexpr std::string_view kOrder[] = {"x", "y", "z", "nx", "ny", "nz"};
    return std::find(std::begin(kOrder), std::end(kOrder), column.property.name) - std::begin(kOrder);
  };
  std::stable_sort(columns.begin(), columns.end(), [&](const Column& a, const Column& b) { return rank(a) < rank(b); });
  const bool single =
      std::all_of(columns.begin(), columns.end(), [](const Column& column) { return column.property.type == Type::kFloat32; });
  const Type type = single ? Type::kFloat32 : Type::kFloat64;
  std::size_t width = 0;
  for (const Column& column : columns) width += column.property.count;

  std::string header = std::string("{'descr': '") + (single ? "<f4" : "<f8") + "', 'fortran_order': False, 'shape': (" +
                       std::to_string(data.size()) + ", " + std::to_string(width) + "), }";
  constexpr std::size_t kFixed = 10;
  constexpr std::size_t kAlign = 64;
  header.append((kAlign - (kFixed + header.size() + 1) % kAlign) % kAlign, ' ');
  header += '\n';
  std::string start("\x93NUMPY\x01\0", 8);
  start += static_cast<char>(header.size() & 255);
  start += static_cast<char>(header.size() >> 8);
  file.write(start + header);
  Rows rows(data, columns);
  std::string record;
  for (std::size_t i = 0; i < data.size(); ++i) {
    rows.next();
    record.clear();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      for (std::uint32_t k = 0; k < columns[c].property.count; ++k) append_double(type, rows.number(c, k), record);
    }
    file.write(record);
  }
}

}  // namespace g3r::io
