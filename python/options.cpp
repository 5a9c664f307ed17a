#include "options.h"

#include <g3r/names.h>

namespace g3r::python {
namespace {

std::vector<Vec3> take_places(const nb::dict& from, const char* name) {
  if (!from.contains(name)) return {};
  return copy_rows<double>(nb::cast<Rows<double>>(from[name]));
}

}  // namespace

Hints read_hints(const nb::dict& from) {
  Hints hints;
  if (from.contains("up") && nb::isinstance<nb::str>(from["up"])) {
    const auto text = nb::cast<std::string>(from["up"]);
    hints.up = parse_direction(text);
    if (!hints.up) throw InvalidInput("up must be three numbers or an axis such as '+z' or '-y', not '" + text + "'");
  } else if (const std::vector<Vec3> up = take_places(from, "up"); !up.empty()) {
    hints.up = up.front();
  }
  hints.sensors = take_places(from, "sensors");
  hints.inside = take_places(from, "inside");
  if (from.contains("sensor_of_point")) {
    hints.sensor_of_point = copy_values<std::uint32_t>(nb::cast<Values<std::uint32_t>>(from["sensor_of_point"]));
  }
  take(from, "seen_from_inside", hints.seen_from_inside);
  take(from, "flip", hints.flip);
  return hints;
}

}  // namespace g3r::python
