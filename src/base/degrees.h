// Angles for people.
#pragma once

#include <numbers>

namespace g3r {

constexpr double degrees(double radians) { return radians * (180 * std::numbers::inv_pi); }

}  // namespace g3r
