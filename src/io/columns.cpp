#include "io/columns.h"

#include "io/cloud_from_table.h"

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
    const std::size_t ours = find_confidence(points);
    const bool same_dialect = data_.table->dialect == dialect_;
    const bool padded = data_.table->dialect == Dialect::kPcd;
    for (std::size_t i = 0; i < points.properties.size(); ++i) {
      Column column;
      column.property = points.properties[i];
      column.in_table = i;
      const bool color = is_in(roles.color, i) || i == roles.packed_color;
      if ((column.property.list && !lists_) || (padded && column.property.name == "_")) continue;
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
      } else if (i == ours && data_.confidence != nullptr) {
        has_confidence_ = true;
        column.from = Column::From::kConfidence;
        if (data_.options.cloud_compare_names) column.property.name = confidence_name();
      } else if (data_.confidence != nullptr && column.property.name == confidence_name()) {
        column.property.name += "_2";
      }
      add(std::move(column));
    }
  }

  // The confidence that is replaced.
  static std::size_t find_confidence(const Element& points) {
    for (const char* name : {"confidence", "scalar_confidence"}) {
      const std::size_t found = points.find(name);
      if (found == Element::npos) continue;
      const Property& property = points.properties[found];
      if (!property.list && property.count == 1 && is_float(property.type)) return found;
    }
    return Element::npos;
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

}  // namespace g3r::io
