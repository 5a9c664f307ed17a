// Shares in words.
#pragma once

#include <cmath>
#include <string>

namespace g3r {

/// A share as a whole number of per cent, "12 %".
[[nodiscard]] inline std::string percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

}  // namespace g3r
