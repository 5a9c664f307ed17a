// Numbers and shares in words.
#pragma once

#include <cmath>
#include <locale>
#include <sstream>
#include <string>

namespace g3r {

/// A number with so many significant digits, as printf's %g in the "C" locale, whatever that of the program is.
[[nodiscard]] inline std::string short_number(double value, int digits = 4) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(digits);
  text << value;
  return text.str();
}

/// A share in per cent, "12 %": whole ones, but below one "0.3 %" and "under 0.01 %", never "0 %" for what is there.
[[nodiscard]] inline std::string percent(double share) {
  const double value = 100 * share;
  if (value > 0 && value < 0.01) return "under 0.01 %";
  return short_number(value > 0 && value < 1 ? value : std::round(value), value > 0 && value < 1 ? 1 : 3) + " %";
}

}  // namespace g3r
