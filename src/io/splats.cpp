#include "io/splats.h"

#include "io/cloud_from_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace g3r::io {

namespace {

constexpr double kHarmonic0 = 0.28209479177387814;  // Y_0 = 1 / (2 sqrt(pi))
constexpr const char* kColorNames[] = {"f_dc_0", "f_dc_1", "f_dc_2"};

bool is_number(const Element& points, const char* name) {
  const std::size_t found = points.find(name);
  return found != Element::npos && !points.properties[found].list;
}

void filter_splats(Attributes& table, double least, std::vector<std::string>& warnings) {
  Element& points = table.elements[table.vertex];
  const RecordLayout layout(points);
  const std::size_t opacity = points.find("opacity");
  const auto is_kept = [&](const char* record) {
    const double logit = load_as_double(points.properties[opacity].type, record + layout.offset(opacity));
    return 1 / (1 + std::exp(-logit)) >= least;
  };
  const std::size_t stride = points.stride();
  std::uint64_t kept = 0;
  for (std::size_t at = 0; at < points.data.size(); at += stride) kept += is_kept(points.data.data() + at) ? 1 : 0;
  if (kept == points.count) return;
  if (kept == 0) {
    warnings.emplace_back("every splat is below the opacity threshold: all are kept");
    return;
  }
  std::size_t end = 0;
  for (std::size_t at = 0; at < points.data.size(); at += stride) {
    if (!is_kept(points.data.data() + at)) continue;
    std::copy_n(points.data.data() + at, stride, points.data.data() + end);
    end += stride;
  }
  points.data.resize(end);
  warnings.push_back(std::to_string(points.count - kept) + " of " + std::to_string(points.count) +
                     " splats are below the opacity threshold and left out");
  points.count = kept;
}

std::vector<std::array<std::uint8_t, 3>> splat_colors(const Element& points) {
  std::vector<std::array<std::uint8_t, 3>> colors(static_cast<std::size_t>(points.count));
  const RecordLayout layout(points);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t property = points.find(kColorNames[c]);
    for (std::size_t i = 0; i < colors.size(); ++i) {
      const char* record = points.data.data() + i * layout.size();
      const double level =
          std::nearbyint(255 * (0.5 + kHarmonic0 * load_as_double(points.properties[property].type, record + layout.offset(property))));
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

void fill_splat_cloud(const Source& source, std::shared_ptr<Attributes> table, double least, Cloud& cloud) {
  filter_splats(*table, least, cloud.warnings);
  std::vector<std::array<std::uint8_t, 3>> colors = splat_colors(table->points());
  fill_cloud(source, std::move(table), cloud);
  cloud.colors = std::move(colors);
  cloud.format += ", Gaussian splats";
}

}  // namespace g3r::io
