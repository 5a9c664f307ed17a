#include "io/splats.h"

#include "io/cloud_from_table.h"
#include "io/splat_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace g3r::io {

namespace {

constexpr double kHarmonic0 = 0.28209479177387814;  // Y_0 = 1 / (2 sqrt(pi))
constexpr const char* kColorNames[] = {"f_dc_0", "f_dc_1", "f_dc_2"};
constexpr const char* kScaleNames[] = {"scale_0", "scale_1", "scale_2"};
constexpr const char* kRotationNames[] = {"rot_0", "rot_1", "rot_2", "rot_3"};

bool is_number(const Element& points, const char* name) {
  const std::size_t found = points.find(name);
  return found != Element::npos && !points.properties[found].list;
}

// The values of one property.
class Column {
 public:
  Column(const Element& points, const char* name)
      : data_(points.data.data()), layout_(points), property_(points.find(name)), type_(points.properties[property_].type) {}
  double operator[](std::size_t i) const { return load_as_double(type_, data_ + i * layout_.size() + layout_.offset(property_)); }

 private:
  const char* data_;
  RecordLayout layout_;
  std::size_t property_;
  Type type_;
};

template <std::size_t Count>
std::vector<Column> columns_of(const Element& points, const char* const (&names)[Count]) {
  std::vector<Column> columns;
  for (const char* name : names) columns.emplace_back(points, name);
  return columns;
}

double opacity_of(double logit) { return 1 / (1 + std::exp(-logit)); }

bool have_reach(const Element& points) {
  const auto are_numbers = [&](const char* name) { return is_number(points, name); };
  return std::all_of(std::begin(kScaleNames), std::end(kScaleNames), are_numbers) &&
         std::all_of(std::begin(kRotationNames), std::end(kRotationNames), are_numbers) && find_roles(points).position[0] != Element::npos;
}

std::vector<SplatPlace> places_in(const Element& points, const ReadOptions& options) {
  const Roles roles = find_roles(points);
  std::vector<Column> position;
  for (const std::size_t axis : roles.position) position.emplace_back(points, points.properties[axis].name.c_str());
  const std::vector<Column> scale = columns_of(points, kScaleNames), rotation = columns_of(points, kRotationNames);
  const Column opacity(points, "opacity");
  std::vector<Splat> splats(static_cast<std::size_t>(points.count));
  for (std::size_t i = 0; i < splats.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) splats[i].centre[a] = position[a][i];
    for (std::size_t a = 0; a < 3; ++a) splats[i].scale[a] = std::exp(scale[a][i]);
    splats[i].axes = axes_of({rotation[0][i], rotation[1][i], rotation[2][i], rotation[3][i]});
    splats[i].opacity = opacity_of(opacity[i]);
  }
  return places_of(splats, options.threads, options.cancel);
}

void keep_only(Element& points, const std::vector<std::uint8_t>& keep) {
  const std::size_t stride = points.stride();
  std::size_t end = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] == 0) continue;
    std::copy_n(points.data.data() + i * stride, stride, points.data.data() + end);
    end += stride;
  }
  points.data.resize(end);
  points.count = end / stride;
}

void filter_splats(Element& points, const ReadOptions& options, std::vector<std::string>& warnings) {
  const Column opacity(points, "opacity");
  std::vector<SplatPlace> place(static_cast<std::size_t>(points.count), SplatPlace::kSurface);
  if (have_reach(points)) place = places_in(points, options);
  std::vector<std::uint8_t> keep(place.size(), 0);
  std::size_t faint = 0, translucent = 0, hidden = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!(opacity_of(opacity[i]) >= options.min_opacity)) {
      ++faint;
    } else if (place[i] == SplatPlace::kTranslucent) {
      ++translucent;
    } else if (place[i] == SplatPlace::kHidden) {
      ++hidden;
    } else {
      keep[i] = 1;
    }
  }
  const std::size_t gone = faint + translucent + hidden;
  if (gone == 0) return;
  if (gone == keep.size()) {
    warnings.emplace_back("every splat is below the opacity threshold or translucent: all are kept");
    return;
  }
  std::string why;
  const auto mention = [&why](std::size_t count, const char* what) {
    if (count != 0) why += (why.empty() ? "" : ", ") + std::to_string(count) + what;
  };
  mention(faint, " below the opacity threshold");
  mention(translucent, " where most of the light passes (floaters)");
  mention(hidden, " that no light from outside reaches (inside)");
  warnings.push_back(std::to_string(gone) + " of " + std::to_string(keep.size()) + " splats are left out: " + why +
                     "; --all-splats keeps them");
  keep_only(points, keep);
}

std::vector<std::array<std::uint8_t, 3>> splat_colors(const Element& points) {
  std::vector<std::array<std::uint8_t, 3>> colors(static_cast<std::size_t>(points.count));
  for (std::size_t c = 0; c < 3; ++c) {
    const Column harmonic(points, kColorNames[c]);
    for (std::size_t i = 0; i < colors.size(); ++i) {
      const double level = std::nearbyint(255 * (0.5 + kHarmonic0 * harmonic[i]));
      colors[i][c] = static_cast<std::uint8_t>(level >= 0 ? std::min(level, 255.0) : 0.0);
    }
  }
  return colors;
}

}  // namespace

bool is_splat(const Element& points) {
  return is_number(points, "opacity") && is_number(points, "f_dc_0") && is_number(points, "f_dc_1") && is_number(points, "f_dc_2") &&
         points.stride() != 0;
}

void fill_splat_cloud(const Source& source, std::shared_ptr<Attributes> table, const ReadOptions& options, Cloud& cloud) {
  if (!options.all_splats) filter_splats(table->elements[table->vertex], options, cloud.warnings);
  std::vector<std::array<std::uint8_t, 3>> colors = splat_colors(table->points());
  fill_cloud(source, std::move(table), cloud);
  cloud.colors = std::move(colors);
  cloud.format += ", Gaussian splats";
}

}  // namespace g3r::io
