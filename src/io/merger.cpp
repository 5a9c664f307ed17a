#include "io/merger.h"

#include <algorithm>
#include <array>
#include <string>

namespace g3r::io {

namespace {

// Those that positions, normals and colours come from.
std::vector<bool> special_properties(const Element& points) {
  const Roles roles = find_roles(points);
  std::vector<bool> special(points.properties.size());
  const auto mark = [&](std::size_t property) {
    if (property != Element::npos) special[property] = true;
  };
  for (std::size_t a = 0; a < 3; ++a) {
    mark(roles.position[a]);
    mark(roles.normal[a]);
    mark(roles.color[a]);
  }
  mark(roles.packed_color);
  return special;
}

}  // namespace

Merger::Merger(const std::vector<Cloud>& clouds, bool deep_colors) : deep_colors_(deep_colors) {
  const auto any = [&](const auto& has) { return std::any_of(clouds.begin(), clouds.end(), has); };
  using What = Column::What;
  const auto triple = [&](const std::array<const char*, 3>& names, Type type, What what) {
    for (std::size_t a = 0; a < 3; ++a) add(names[a], type, {what, a});
  };
  const bool doubles = any([](const Cloud& c) { return c.scalar == Scalar::kFloat64; });
  triple({"x", "y", "z"}, doubles ? Type::kFloat64 : Type::kFloat32, What::kPosition);
  if (any([](const Cloud& c) { return !c.normals.empty(); })) triple({"nx", "ny", "nz"}, Type::kFloat64, What::kNormal);
  if (any([](const Cloud& c) { return !c.colors.empty(); })) {
    triple({"red", "green", "blue"}, deep_colors ? Type::kUint16 : Type::kUint8, What::kColor);
  }
  const std::size_t known = element_.properties.size();
  for (const Cloud& cloud : clouds) {
    if (cloud.attributes == nullptr) continue;
    if (cloud.attributes->dialect != Attributes::Dialect::kPly) dialect_ = Attributes::Dialect::kNone;
    const Element& points = cloud.attributes->points();
    const std::vector<bool> special = special_properties(points);
    for (std::size_t i = 0; i < points.properties.size(); ++i) {
      const Property& property = points.properties[i];
      const std::size_t found = element_.find(property.name);
      if (property.name == "_" && cloud.attributes->dialect == Attributes::Dialect::kPcd) continue;  // padding
      if (!special[i] && !property.list && property.count == 1 && (found == Element::npos || found >= known))
        add(property.name, property.type, {What::kProperty, 0});
    }
  }
}

void Merger::add(const std::string& name, Type type, Column column) {
  const std::size_t found = element_.find(name);
  if (found == Element::npos) {
    element_.add(name, type);
    columns_.push_back(column);
  } else if (element_.properties[found].type != type) {
    element_.properties[found].type = Type::kFloat64;
  }
}

void Merger::append(const Cloud& cloud, const RecordColors* colors) {
  const Element* points = cloud.attributes == nullptr ? nullptr : &cloud.attributes->points();
  std::vector<std::size_t> from(columns_.size(), Element::npos);
  for (std::size_t c = 0; points != nullptr && c < columns_.size(); ++c) {
    if (columns_[c].what == Column::What::kProperty) from[c] = points->find(element_.properties[c].name);
  }
  static const Element kNothing;
  RecordLayout layout(points == nullptr ? kNothing : *points);
  const char* record = points == nullptr ? nullptr : points->data.data();
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    if (record != nullptr) layout.seek(record);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      double value = 0;
      if (colors != nullptr && deep_colors_ && columns_[c].what == Column::What::kColor) {
        value = colors->deep_color(layout, record)[columns_[c].axis];
      } else if (from[c] != Element::npos) {
        value = load_as_double(points->properties[from[c]].type, record + layout.offset(from[c]));
      } else {
        value = own_value(cloud, columns_[c], i);
      }
      append_double(element_.properties[c].type, value, element_.data);
    }
    if (record != nullptr) record += layout.size();
  }
  element_.count += cloud.positions.size();
}

Element Merger::take() {
  std::string records;
  records.swap(element_.data);
  Element out = element_;
  out.data.swap(records);
  element_.count = 0;
  return out;
}

double Merger::own_value(const Cloud& cloud, const Column& column, std::size_t i) const {
  switch (column.what) {
    case Column::What::kPosition:
      return cloud.positions[i][column.axis];
    case Column::What::kNormal:
      return cloud.normals.empty() ? 0 : cloud.normals[i][column.axis];
    case Column::What::kColor:
      return cloud.colors.empty() ? 0 : cloud.colors[i][column.axis] * (deep_colors_ ? kDeepSteps : 1);
    case Column::What::kProperty:
      break;
  }
  return 0;
}

}  // namespace g3r::io
