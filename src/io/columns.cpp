#include "io/columns.h"

#include "io/cloud_from_table.h"
#include "io/text.h"

#include <algorithm>
#include <cmath>

namespace g3r::io {

namespace {

using Dialect = Attributes::Dialect;

constexpr const char* kAxes[] = {"x", "y", "z"};

Column make(const char* name, Type type, Column::From from, std::size_t axis = 0) {
  Column column;
  column.property.name = name;
  column.property.type = type;
  column.from = from;
  column.axis = axis;
  return column;
}

const char* normal_name(Dialect dialect, std::size_t axis) {
  constexpr const char* kPly[] = {"nx", "ny", "nz"};
  constexpr const char* kPcd[] = {"normal_x", "normal_y", "normal_z"};
  constexpr const char* kLas[] = {"NormalX", "NormalY", "NormalZ"};
  return (dialect == Dialect::kPcd ? kPcd : dialect == Dialect::kLas ? kLas : kPly)[axis];
}

bool is_in(const std::size_t* triple, std::size_t property) { return std::find(triple, triple + 3, property) != triple + 3; }

class Planner {
 public:
  Planner(const PointData& data, Dialect dialect, bool lists) : data_(data), dialect_(dialect), lists_(lists) {}

  std::vector<Column> plan() {
    if (data_.table != nullptr) {
      from_table(data_.table->points());
    } else {
      const Type type = data_.cloud.scalar == Scalar::kFloat32 ? Type::kFloat32 : Type::kFloat64;
      for (std::size_t a = 0; a < 3; ++a) add(make(kAxes[a], type, Column::From::kPosition, a));
    }
    if (!data_.cloud.colors.empty() && !has_color_) add_color();
    if (data_.normals != nullptr && !has_normal_) {
      for (std::size_t a = 0; a < 3; ++a) add(make(normal_name(dialect_, a), Type::kFloat32, Column::From::kNormal, a));
    }
    if (data_.confidence != nullptr && !has_confidence_) add(make(confidence_name(), Type::kFloat32, Column::From::kConfidence));
    make_names_unique();
    return std::move(columns_);
  }

 private:
  [[nodiscard]] const char* confidence_name() const { return data_.options.cloud_compare_names ? "scalar_confidence" : "confidence"; }

  void from_table(const Element& points) {
    const Roles roles = find_roles(points);
    const bool same_dialect = data_.table->dialect == dialect_;
    for (std::size_t i = 0; i < points.properties.size(); ++i) {
      Column column;
      column.property = points.properties[i];
      column.in_table = i;
      const bool color = is_in(roles.color, i) || i == roles.packed_color;
      if (column.property.list && !lists_) continue;
      if (color && !same_dialect) {
        if (!has_color_ && !data_.cloud.colors.empty()) add_color();
        continue;
      }
      has_color_ = has_color_ || color;
      if (is_in(roles.position, i)) {
        column.from = Column::From::kPosition;
        column.axis = static_cast<std::size_t>(std::find(roles.position, roles.position + 3, i) - roles.position);
        column.property.name = kAxes[column.axis];  // in small letters, which all programs know
      } else if (is_in(roles.normal, i)) {
        has_normal_ = true;
        column.axis = static_cast<std::size_t>(std::find(roles.normal, roles.normal + 3, i) - roles.normal);
        if (!same_dialect) column.property.name = normal_name(dialect_, column.axis);
        if (data_.normals != nullptr) {
          column.from = Column::From::kNormal;
          if (!is_float(column.property.type)) column.property.type = Type::kFloat32;
        }
      } else if (i == roles.confidence && data_.confidence != nullptr) {
        has_confidence_ = true;
        column.from = Column::From::kConfidence;
        if (!is_float(column.property.type)) column.property.type = Type::kFloat32;
        if (data_.options.cloud_compare_names) column.property.name = confidence_name();
      }
      add(std::move(column));
    }
  }

  void add_color() {
    has_color_ = true;
    constexpr const char* kNames[] = {"red", "green", "blue"};
    if (dialect_ == Dialect::kPcd) return add(make("rgb", Type::kFloat32, Column::From::kPackedColor));
    for (std::size_t c = 0; c < 3; ++c) add(make(kNames[c], Type::kUint8, Column::From::kColor, c));
  }

  void add(Column column) { columns_.push_back(std::move(column)); }

  // A file may name two properties alike in ways that another format cannot; readers refuse twins.
  void make_names_unique() {
    std::vector<std::string_view> names;
    names.reserve(columns_.size());
    for (const Column& column : columns_) names.push_back(column.property.name);
    std::sort(names.begin(), names.end());
    if (std::adjacent_find(names.begin(), names.end()) == names.end()) return;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const auto twin = [&](const Column& other) { return other.property.name == columns_[i].property.name; };
      const auto end = columns_.begin() + static_cast<std::ptrdiff_t>(i);
      for (int suffix = 2; std::any_of(columns_.begin(), end, twin); ++suffix) (columns_[i].property.name += '_') += std::to_string(suffix);
    }
  }

  const PointData& data_;
  Dialect dialect_;
  bool lists_;
  std::vector<Column> columns_;
  bool has_color_ = false;
  bool has_normal_ = false;
  bool has_confidence_ = false;
};

}  // namespace

PointData check_points(const Cloud& cloud, const std::vector<Vec3>* normals, const std::vector<float>* confidence,
                       const WriteOptions& options) {
  const std::size_t count = cloud.positions.size();
  const auto check = [&](std::size_t size, const char* what) {
    if (size != count) {
      throw InvalidInput("write_cloud: " + std::to_string(size) + " " + what + " for " + std::to_string(count) + " points");
    }
  };
  if (normals != nullptr) {
    check(normals->size(), "normals");
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& n = (*normals)[i];
      if (!std::isfinite(n[0]) || !std::isfinite(n[1]) || !std::isfinite(n[2])) {
        throw InvalidInput("write_cloud: normal " + std::to_string(i) + " is not finite");
      }
    }
  }
  if (confidence != nullptr) check(confidence->size(), "confidences");
  if (!cloud.colors.empty()) check(cloud.colors.size(), "colours");
  if (cloud.attributes != nullptr)
    check(static_cast<std::size_t>(cloud.attributes->points().count), "records of attributes (set attributes to null?)");
  // Without a table the cloud's own normals and confidence are all there is.
  if (cloud.attributes == nullptr && normals == nullptr && !cloud.normals.empty()) {
    check(cloud.normals.size(), "normals");
    normals = &cloud.normals;
  }
  if (cloud.attributes == nullptr && confidence == nullptr && !cloud.confidence.empty()) {
    check(cloud.confidence.size(), "confidences");
    confidence = &cloud.confidence;
  }
  return {cloud, normals, confidence, cloud.attributes.get(), options};
}

std::vector<Column> plan_columns(const PointData& data, Dialect dialect, bool lists) { return Planner(data, dialect, lists).plan(); }

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
    case Column::From::kPackedColor: {
      const auto& c = data_.cloud.colors[point_];
      return bits_as<float>(static_cast<std::uint32_t>(c[0]) << 16 | static_cast<std::uint32_t>(c[1]) << 8 | c[2]);
    }
    case Column::From::kTable:
      break;
  }
  const Type type = data_.table->points().properties[column.in_table].type;
  return load_as_double(type, field(index) + k * size_of(type));
}

void Rows::append_bytes(std::size_t index, std::string& bytes) {
  const Column& column = (*columns_)[index];
  if (column.from == Column::From::kTable && data_.table->points().properties[column.in_table].type == column.property.type) {
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
