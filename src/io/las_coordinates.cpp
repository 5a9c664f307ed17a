#include "io/las_coordinates.h"

#include "io/text_numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace g3r::io {

namespace {

// Whether steps are coarser than the numbers as they were read: half a unit in the last place of the largest.
bool are_coarse(double scale, double largest, Scalar precision) {
  const double relative = precision == Scalar::kFloat32 ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
  return scale > relative * largest;
}

}  // namespace

void LasCoordinates::add(const Vec3& position) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double value = position[a];
    if (!std::isfinite(value)) throw InvalidInput("write_cloud: LAS cannot hold coordinates that are not finite");
    bounds_.low[a] = count_ == 0 ? value : std::min(bounds_.low[a], value);
    bounds_.high[a] = count_ == 0 ? value : std::max(bounds_.high[a], value);
    decimals_[a].add(value);
  }
  ++count_;
}

std::string LasCoordinates::finish() {
  constexpr const char* kAxisNames[] = {"x", "y", "z"};
  std::string rounded;
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = bounds_.low[a];
    const double high = bounds_.high[a];
    const std::optional<int> decimals = count_ == 0 ? std::nullopt : decimals_[a].count();
    const std::optional<DecimalSteps> exact = decimals ? exact_steps(low, high, *decimals) : std::nullopt;
    steps_[a] = exact ? *exact : fine_steps(low, high);
    if (exact || !are_coarse(steps_[a].scale(), std::max(std::abs(low), std::abs(high)), precision_)) continue;
    rounded += (rounded.empty() ? "" : ", ") + std::string(kAxisNames[a]) + " to " + number_text(steps_[a].scale());
  }
  if (rounded.empty()) return "";
  return "coordinates are rounded (" + rounded + "): with all their digits they need more than the 32 bits of LAS";
}

}  // namespace g3r::io
