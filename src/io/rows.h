// The values of the columns that a point file gets (columns.h), as bytes and as text.
#pragma once

#include "io/columns.h"
#include "io/output_file.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::io {

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
  [[nodiscard]] std::uint32_t packed_color() const;  // the bits

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
