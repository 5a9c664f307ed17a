#include "io/decimal_steps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace g3r::io {

namespace {

constexpr double kExactWhole = 9007199254740992;  // 2^53: whole numbers up to here are doubles
constexpr double kMostSteps = 2147483648;         // 2^31, of the numbers that LAS and EPT store
constexpr int kMostExact = 22;                    // 10^22 is the largest power of ten that is a double
constexpr double kRound = 1e6;                    // steps, of which offsets are a multiple: short numbers that people can read

bool gives_back(double value, int decimals, Scalar precision) {
  const double power = power_of_ten(decimals);
  const double whole = std::nearbyint(value * power);
  if (!(std::abs(whole) < kExactWhole)) return false;
  // Both are exact, so that the quotient is what a text of so many decimals is read as.
  const double again = whole / power;
  return precision == Scalar::kFloat32 ? static_cast<float>(again) == static_cast<float>(value) : again == value;
}

}  // namespace

double power_of_ten(int exponent) {
  double power = 1;
  for (int k = 0; k < std::abs(exponent); ++k) power *= 10;
  return exponent < 0 ? 1 / power : power;
}

DecimalSteps::DecimalSteps(double scale, double offset) : scale_(scale), offset_(offset) {
  for (int decimals = 0; decimals <= kMostExact; ++decimals) {
    const double power = power_of_ten(decimals);
    if (scale != 1 / power) continue;
    const double shift = std::nearbyint(offset * power);
    if (shift / power != offset || !(std::abs(shift) + kMostSteps < kExactWhole)) return;
    power_ = power;
    shift_ = shift;
    return;
  }
}

double DecimalSteps::steps(double value) const {
  return power_ > 0 ? std::nearbyint(value * power_) - shift_ : std::nearbyint((value - offset_) / scale_);
}

void Decimals::add(double value) {
  while (count_ <= kMost && !gives_back(value, count_, precision_)) ++count_;
}

std::optional<DecimalSteps> exact_steps(double low, double high, int decimals) {
  constexpr double kMostInt = std::numeric_limits<std::int32_t>::max();
  const double power = power_of_ten(decimals);
  const double first = std::nearbyint(low * power);
  const double last = std::nearbyint(high * power);
  const bool near_zero = std::max(std::abs(first), std::abs(last)) <= kMostInt;
  const double shift = near_zero ? 0 : std::floor((first + last) / (2 * kRound)) * kRound;
  if (std::max(std::abs(first - shift), std::abs(last - shift)) > kMostInt) return std::nullopt;
  return DecimalSteps(1 / power, shift / power);
}

DecimalSteps fine_steps(double low, double high) {
  constexpr double kSteps = 2e9;       // The extent has so many steps at most: the numbers of LAS have 32 bits, half of them negative.
  constexpr double kLeastPart = 1e-6;  // of the coordinates: an extent below it gets no finer steps, whose offset would need more digits
  constexpr int kOfNoExtent = -9;      // decimal exponent of the steps of points that are all at the origin
  const double extent = std::max(high - low, kLeastPart * std::max(std::abs(low), std::abs(high)));
  const bool usual = extent > 0 && std::isfinite(extent);
  const int exponent = usual ? static_cast<int>(std::ceil(std::log10(extent / kSteps))) : kOfNoExtent;
  double scale = std::abs(exponent) <= kMostExact ? power_of_ten(exponent) : std::pow(10.0, exponent);
  if (!(scale > 0)) scale = std::numeric_limits<double>::min();
  const double middle = low / 2 + high / 2;
  double offset = std::floor(middle / (scale * kRound)) * (scale * kRound);
  if (exponent < 0 && exponent >= -kMostExact) {
    const double power = power_of_ten(-exponent);
    offset = std::floor(middle * (power / kRound)) * kRound / power;
  }
  if (!std::isfinite(offset)) offset = middle;
  return DecimalSteps(scale, offset);
}

}  // namespace g3r::io
