#include "view/pack.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace g3r::view {

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = (word << 8U) | (k < have ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= have ? kDigits[(word >> (18 - 6 * k)) & 63U] : '=';
  }
  return text;
}

void append_position(std::vector<std::uint8_t>& out, const Vec3& p, const Box& box) {
  const double side = box.longest_side();
  for (std::size_t k = 0; k < 3; ++k) {
    const double u = side > 0 ? (p[k] - box.low[k]) / side : 0;
    const auto q = static_cast<std::uint32_t>(std::lround(65535 * std::clamp(std::isfinite(u) ? u : 0, 0.0, 1.0)));
    out.push_back(static_cast<std::uint8_t>(q & 255U));
    out.push_back(static_cast<std::uint8_t>(q >> 8U));
  }
}

void append_normal(std::vector<std::uint8_t>& out, const Vec3& n) {
  const Vec3 unit = unit_or_zero(n);
  const double sum = std::abs(unit[0]) + std::abs(unit[1]) + std::abs(unit[2]);
  int x = -127, y = -127;
  if (sum > 0) {
    double u = unit[0] / sum, v = unit[1] / sum;
    if (unit[2] < 0) {
      const double folded = (1 - std::abs(v)) * (u >= 0 ? 1 : -1);
      v = (1 - std::abs(u)) * (v >= 0 ? 1 : -1);
      u = folded;
    }
    x = static_cast<int>(std::lround(127 * u));
    y = static_cast<int>(std::lround(127 * v));
    if (x == -127 && y == -127) x = y = 127;  // all four corners of the map are the direction -z
  }
  out.push_back(static_cast<std::uint8_t>(x & 255));
  out.push_back(static_cast<std::uint8_t>(y & 255));
}

void append_unit(std::vector<std::uint8_t>& out, float value) {
  out.push_back(static_cast<std::uint8_t>(std::lround(255 * (std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 0.0F))));
}

void append_index(std::vector<std::uint8_t>& out, std::uint32_t index) {
  for (unsigned shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>((index >> shift) & 255U));
}

}  // namespace g3r::view
