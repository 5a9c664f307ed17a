#include "io/las_column.h"

#include "io/text_numbers.h"

#include <algorithm>
#include <cmath>

namespace g3r::io {

void LasColumn::add(double value) {
  if (!std::isfinite(value)) {
    if (finite && whole) odd = value;
    finite = whole = false;
    return;
  }
  low = std::min(low, value);
  high = std::max(high, value);
  if (whole && value != std::nearbyint(value)) {
    odd = value;
    whole = false;
  }
}

bool LasColumn::fits(const LasPlace& place) const {
  if (place.bits == 64) return finite;
  return place.bits != 0 && whole && low >= place.low && high <= place.high;
}

std::string LasColumn::misfit(const LasPlace& place) const {
  if (place.bits == 64) return "LAS holds finite numbers there, and some are not";
  const double found = !whole ? odd : low < place.low ? low : high;
  return "LAS holds whole numbers from " + number_text(place.low) + " to " + number_text(place.high) + " there, found " +
         number_text(found);
}

}  // namespace g3r::io
