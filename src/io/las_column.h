// The numbers of a column that is called after a field of LAS, and whether the field holds them.
#pragma once

#include "io/las_fields.h"

#include <cstddef>
#include <string>

namespace g3r::io {

struct LasColumn {
  std::size_t column = 0;
  LasPart part = LasPart::kNone;
  double low = 0;  ///< of the finite numbers and 0, which every field holds
  double high = 0;
  bool whole = true;
  bool finite = true;
  double odd = 0;  ///< the first that is not whole

  /// Takes note of a number.
  void add(double value);
  /// Whether the place holds all of them.
  [[nodiscard]] bool fits(const LasPlace& place) const;
  /// Why it does not, for a message.
  [[nodiscard]] std::string misfit(const LasPlace& place) const;
};

}  // namespace g3r::io
