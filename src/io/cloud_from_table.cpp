#include "io/cloud_from_table.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace g3r::io {

namespace {

constexpr std::size_t kNone = Element::npos;

bool is_number(const Property& property) { return !property.list && property.count == 1; }

std::size_t find_first(const Element& points, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    const std::size_t found = points.find(name);
    if (found != kNone && is_number(points.properties[found])) return found;
  }
  return kNone;
}

void find_triple(const Element& points, const std::initializer_list<std::string_view>* names, std::size_t* found) {
  for (int axis = 0; axis < 3; ++axis) found[axis] = find_first(points, names[axis]);
  if (found[0] == kNone || found[1] == kNone || found[2] == kNone) std::fill_n(found, 3, kNone);
}

// The whole number from 0 to `most` that is nearest.
double to_level(double value, double most) {
  const double level = std::nearbyint(value);
  return level >= 0 ? std::min(level, most) : 0.0;
}

void require_positions(const Source& source, const Element& points) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  constexpr const char* kCapitals[] = {"X", "Y", "Z"};
  for (int a = 0; a < 3; ++a) {
    const std::string axis = kAxes[a];
    const std::size_t found = std::min(points.find(axis), points.find(kCapitals[a]));
    if (found == kNone) fail(source, "no property \"" + axis + "\" (field " + axis + "): points need the properties x, y and z");
    if (find_first(points, {axis, kCapitals[a]}) == kNone)
      fail(source, "the property \"" + axis + "\" is a list: expected one number (count 1)");
  }
}

}  // namespace

double color_scale(Type type, double largest) {
  constexpr double kSlack = 2;  // Floats of 0..1 may be above 1 here and there, by rounding or where light is strong.
  if (size_of(type) == 1) return 1;
  if (largest > 255) return 1.0 / kDeepSteps;
  return is_float(type) && largest < kSlack ? 255 : 1;
}

std::uint8_t to_color(double value, double scale) { return static_cast<std::uint8_t>(to_level(value * scale, 255)); }

Roles find_roles(const Element& points) {
  Roles roles{};
  const std::initializer_list<std::string_view> position[] = {{"x", "X"}, {"y", "Y"}, {"z", "Z"}};
  const std::initializer_list<std::string_view> normal[] = {{"nx", "normal_x", "NormalX", "normalx", "n_x"},
                                                            {"ny", "normal_y", "NormalY", "normaly", "n_y"},
                                                            {"nz", "normal_z", "NormalZ", "normalz", "n_z"}};
  const std::initializer_list<std::string_view> color[] = {
      {"red", "r", "diffuse_red"}, {"green", "g", "diffuse_green"}, {"blue", "b", "diffuse_blue"}};
  find_triple(points, position, roles.position);
  find_triple(points, normal, roles.normal);
  find_triple(points, color, roles.color);
  roles.packed_color = find_first(points, {"rgb", "rgba"});
  if (roles.packed_color != kNone && size_of(points.properties[roles.packed_color].type) != 4) roles.packed_color = kNone;
  roles.confidence = find_first(points, {"confidence", "scalar_confidence", "quality", "scalar_quality"});
  return roles;
}

RecordColors::RecordColors(const Element& points) : points_(points) {
  const Roles roles = find_roles(points);
  std::copy_n(roles.color, 3, channel_.begin());
  channels_ = roles.color[0] != kNone;
  if (!channels_) packed_ = roles.packed_color;
}

void RecordColors::measure(const char* records, std::uint64_t count) {
  RecordLayout layout(points_);
  for (std::uint64_t i = 0; i < count && exist(); ++i, records += layout.size()) {
    layout.seek(records);
    if (!channels_) packed_bits_ |= load<std::uint32_t>(records + layout.offset(packed_)) & 0xFFFFFFU;
    for (std::size_t c = 0; c < 3 && channels_; ++c) {
      const double value = load_as_double(points_.properties[channel_[c]].type, records + layout.offset(channel_[c]));
      if (std::isfinite(value)) largest_[c] = std::max(largest_[c], value);
    }
  }
  scale_ = 255;  // the largest that there is; one channel of 0..255 means that all are
  for (std::size_t c = 0; c < 3 && channels_; ++c) {
    scale_ = std::min(scale_, color_scale(points_.properties[channel_[c]].type, largest_[c]));
  }
}

bool RecordColors::are_black() const {
  if (!channels_) return packed_bits_ == 0;
  return std::all_of(largest_.begin(), largest_.end(), [&](double value) { return to_color(value, scale_) == 0; });
}

bool RecordColors::agree(const std::vector<RecordColors*>& all) {
  const auto is_deep = [](const RecordColors* colors) { return colors->scale_ < 1; };
  for (const bool floats : {false, true}) {
    std::vector<RecordColors*> alike;
    for (RecordColors* colors : all) {
      const bool deepens = colors->channels_ && colors->scale_ <= 1 && size_of(colors->first_type()) > 1;
      if (deepens && is_float(colors->first_type()) == floats) alike.push_back(colors);
    }
    if (std::none_of(alike.begin(), alike.end(), is_deep)) continue;
    for (RecordColors* colors : alike) colors->scale_ = 1.0 / kDeepSteps;
  }
  const bool deep = std::any_of(all.begin(), all.end(), is_deep);
  for (RecordColors* colors : all) colors->deep_ = deep;
  return deep;
}

std::array<double, 3> RecordColors::levels(const RecordLayout& layout, const char* record) const {
  if (!channels_) {
    const auto packed = load<std::uint32_t>(record + layout.offset(packed_));
    return {static_cast<double>(packed >> 16 & 255U), static_cast<double>(packed >> 8 & 255U), static_cast<double>(packed & 255U)};
  }
  std::array<double, 3> levels{};
  for (std::size_t c = 0; c < 3; ++c) {
    levels[c] = scale_ * load_as_double(points_.properties[channel_[c]].type, record + layout.offset(channel_[c]));
  }
  return levels;
}

std::array<std::uint16_t, 3> RecordColors::deep_color(const RecordLayout& layout, const char* record) const {
  std::array<std::uint16_t, 3> color{};
  const std::array<double, 3> exact = levels(layout, record);
  for (std::size_t c = 0; c < 3; ++c) color[c] = static_cast<std::uint16_t>(to_level(exact[c] * kDeepSteps, 65535));
  return color;
}

std::array<std::uint8_t, 3> RecordColors::color(const RecordLayout& layout, const char* record) const {
  std::array<std::uint8_t, 3> color{};
  std::array<double, 3> exact = levels(layout, record);
  if (deep_) {
    const std::array<std::uint16_t, 3> deep = deep_color(layout, record);
    for (std::size_t c = 0; c < 3; ++c) exact[c] = static_cast<double>(deep[c]) / kDeepSteps;
  }
  for (std::size_t c = 0; c < 3; ++c) color[c] = to_color(exact[c], 1);
  return color;
}

void fill_cloud(const Source& source, std::shared_ptr<const Attributes> table, Cloud& cloud) {
  const Element& points = table->points();
  require_positions(source, points);
  const Roles roles = find_roles(points);
  const auto has = [](const std::size_t* triple) { return triple[0] != kNone; };
  const auto type = [&](std::size_t property) { return points.properties[property].type; };
  const auto count = static_cast<std::size_t>(points.count);  // the records are in memory, so it fits

  cloud.positions.reserve(count);
  if (has(roles.normal)) cloud.normals.reserve(count);
  if (roles.confidence != kNone) cloud.confidence.reserve(count);
  cloud.scalar = std::all_of(roles.position, roles.position + 3, [&](std::size_t p) { return type(p) == Type::kFloat32; })
                     ? Scalar::kFloat32
                     : Scalar::kFloat64;

  RecordLayout layout(points);
  RecordColors colors(points);
  colors.measure(points.data.data(), points.count);
  if (colors.exist()) cloud.colors.reserve(count);
  bool any_normal = false;
  const char* record = points.data.data();
  for (std::size_t i = 0; i < count; ++i, record += layout.size()) {
    layout.seek(record);
    const auto number = [&](std::size_t property) { return load_as_double(type(property), record + layout.offset(property)); };
    const auto triple = [&](const std::size_t* p) { return Vec3{number(p[0]), number(p[1]), number(p[2])}; };
    cloud.positions.push_back(triple(roles.position));
    if (has(roles.normal)) {
      cloud.normals.push_back(triple(roles.normal));
      const Vec3& n = cloud.normals.back();
      any_normal = any_normal || n[0] != 0 || n[1] != 0 || n[2] != 0;
    }
    if (colors.exist()) cloud.colors.push_back(colors.color(layout, record));
    if (roles.confidence != kNone) {
      float value = 0;
      store_double(Type::kFloat32, number(roles.confidence), reinterpret_cast<char*>(&value));
      cloud.confidence.push_back(value);
    }
  }
  if (!any_normal && !cloud.normals.empty()) {
    cloud.normals = {};
    cloud.warnings.emplace_back("all normals in the file are zero: they are not used");
  }
  cloud.property_names.reserve(points.properties.size());
  for (const Property& property : points.properties) cloud.property_names.push_back(property.name);
  cloud.attributes = std::move(table);
}

}  // namespace g3r::io
