#include "io/rows.h"

#include "io/text_numbers.h"

namespace g3r::io {

Rows::Rows(const PointData& data, const std::vector<Column>& columns) : data_(data), columns_(&columns) {
  if (data.table == nullptr) return;
  layout_storage_.emplace_back(data.table->points());
  layout_ = layout_storage_.data();
  record_ = data.table->points().data.data();
}

void Rows::next() {
  ++point_;
  if (layout_ == nullptr) return;
  if (point_ != 0) record_ += layout_->size();
  layout_->seek(record_);
}

double Rows::number(std::size_t index, std::size_t k) {
  const Column& column = (*columns_)[index];
  switch (column.from) {
    case Column::From::kPosition:
      return data_.cloud.positions[point_][column.axis];
    case Column::From::kNormal:
      return (*data_.normals)[point_][column.axis];
    case Column::From::kColor:
      return data_.cloud.colors[point_][column.axis];
    case Column::From::kConfidence:
      return (*data_.confidence)[point_];
    case Column::From::kPackedColor:
      return bits_as<float>(packed_color());
    case Column::From::kTable:
    case Column::From::kTableBits:
      break;
  }
  const Type type = data_.table->points().properties[column.in_table].type;
  return load_as_double(type, field(index) + k * size_of(type));
}

std::uint32_t Rows::packed_color() const {
  const auto& c = data_.cloud.colors[point_];
  return static_cast<std::uint32_t>(c[0]) << 16 | static_cast<std::uint32_t>(c[1]) << 8 | c[2];
}

void Rows::append_bytes(std::size_t index, std::string& bytes) {
  const Column& column = (*columns_)[index];
  if (column.from == Column::From::kPackedColor) {
    const std::uint32_t bits = packed_color();
    bytes.append(reinterpret_cast<const char*>(&bits), sizeof bits);
    return;
  }
  const bool same_type =
      column.from == Column::From::kTable && data_.table->points().properties[column.in_table].type == column.property.type;
  if (same_type || column.from == Column::From::kTableBits) {
    bytes.append(field(index), layout_->bytes(column.in_table));
    return;
  }
  for (std::size_t k = 0; k < column.property.count; ++k) append_double(column.property.type, number(index, k), bytes);
}

void append_as_text(Type type, const char* bytes, std::string& text) {
  switch (type) {
    case Type::kFloat32:
      return append_number(text, load<float>(bytes));
    case Type::kFloat64:
      return append_number(text, load<double>(bytes));
    case Type::kUint64:
      return append_number(text, load<std::uint64_t>(bytes));
    case Type::kInt64:
      return append_number(text, load<std::int64_t>(bytes));
    default:
      append_number(text, static_cast<std::int64_t>(load_as_double(type, bytes)));
  }
}

const char* append_property_as_text(const Property& property, const char* bytes, std::string& text) {
  std::size_t length = property.count;
  if (property.list) {
    length = static_cast<std::size_t>(load_as_double(property.count_type, bytes));
    append_as_text(property.count_type, bytes, text);
    text += ' ';
    bytes += size_of(property.count_type);
  }
  for (std::size_t k = 0; k < length; ++k, bytes += size_of(property.type)) {
    append_as_text(property.type, bytes, text);
    text += ' ';
  }
  return bytes;
}

void write_rows(const PointData& data, const std::vector<Column>& columns, OutputFile& file) {
  Rows rows(data, columns);
  std::string bytes;
  std::string text;
  for (std::size_t i = 0; i < data.size(); ++i) {
    rows.next();
    bytes.clear();
    for (std::size_t c = 0; c < columns.size(); ++c) rows.append_bytes(c, bytes);
    if (!data.options.ascii) {
      file.write(bytes);
      continue;
    }
    text.clear();
    const char* at = bytes.data();
    for (const Column& column : columns) at = append_property_as_text(column.property, at, text);
    text.back() = '\n';
    file.write(text);
  }
}

}  // namespace g3r::io
