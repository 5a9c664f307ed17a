// What the columns of a text with one point per line are. Columns without names are distinguished by their values; those that hold text are
// left out.
#pragma once

#include "io/point_rows.h"
#include "io/table.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace g3r::io {

/// The columns that become part of the points.
struct TextColumns {
  std::vector<Property> properties;  ///< doubles
  std::vector<std::size_t> kept;     ///< the column of each; others hold text
  bool overflow = false;
  std::vector<std::string> warnings;
};

/// Reads the numbers once, and up to twice more where columns have no names. `store`, where given, gets all columns of each point, once.
/// Throws InvalidInput.
TextColumns find_columns(const Text& text, const TextShape& shape, const std::function<void(const double*)>& store = {});

}  // namespace g3r::io
