// What a point file gets: the properties of the cloud's table in their order, with normals and confidence replaced or added.
#pragma once

#include "io/output_file.h"
#include "io/table.h"

#include <string>
#include <vector>

namespace g3r::io {

/// One property to write and where its value comes from.
struct Column {
  enum class From { kTable, kPosition, kNormal, kColor, kPackedColor, kConfidence };
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

/// The values of the columns, point by point.
class Rows {
 public:
  Rows(const PointData& data, const std::vector<Column>& columns);
  /// Moves to the next point; the first call moves to the first.
  void next();
  /// Appends the bytes of a column, in its type.
  void append_bytes(std::size_t column, std::string& bytes);
  /// The k-th number of a column that is no list.
  double number(std::size_t column, std::size_t k = 0);
  /// The table's bytes of a column from the table.
  [[nodiscard]] const char* field(std::size_t column) const { return record_ + layout_->offset((*columns_)[column].in_table); }

 private:
  const PointData& data_;
  const std::vector<Column>* columns_;
  std::vector<RecordLayout> layout_storage_;
  RecordLayout* layout_ = nullptr;
  const char* record_ = nullptr;
  std::size_t point_ = static_cast<std::size_t>(-1);
};

/// Writes the points row by row, binary or as text with a blank between numbers, as the options of `data` ask.
void write_rows(const PointData& data, const std::vector<Column>& columns, OutputFile& file);

/// Appends the number or numbers of one property as text, each before a blank; returns where the property ends.
const char* append_property_as_text(const Property& property, const char* bytes, std::string& text);

/// Appends a number of a stored type as text, the shortest that reads back the same.
void append_as_text(Type type, const char* bytes, std::string& text);

}  // namespace g3r::io
