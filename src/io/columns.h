// What a point file gets: the properties of the cloud's table in their order, with normals and confidence replaced or added. Replaced is a
// confidence that is a float, as g3r writes it; another kind of number of this name gets another name. PCD's padding is left out.
#pragma once

#include "io/table.h"

#include <cstddef>
#include <vector>

namespace g3r::io {

/// One property to write and where its value comes from.
struct Column {
  enum class From { kTable, kTableBits, kPosition, kNormal, kColor, kPackedColor, kConfidence };  // kTableBits: whatever the type
  Property property;
  From from = From::kTable;
  std::size_t axis = 0;      ///< of a position, normal or colour
  std::size_t in_table = 0;  ///< index of the table's property
};

/// The input of a point writer, checked.
struct PointData {
  const Cloud& cloud;
  const std::vector<Vec3>* normals;      ///< to be written, or null
  const std::vector<float>* confidence;  ///< to be written, or null
  const Attributes* table;               ///< or null
  const WriteOptions& options;
  [[nodiscard]] std::size_t size() const { return cloud.positions.size(); }
};

/// Checks sizes and finiteness. Normals and confidence default to the cloud's own where it has no table.
/// Throws InvalidInput.
PointData check_points(const Cloud& cloud, const std::vector<Vec3>* normals, const std::vector<float>* confidence,
                       const WriteOptions& options);

/// The columns for a format whose properties are named in `dialect`. `lists`: whether it can hold lists.
std::vector<Column> plan_columns(const PointData& data, Attributes::Dialect dialect, bool lists);

}  // namespace g3r::io
