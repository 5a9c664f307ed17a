// From typed records to a Cloud: which properties are coordinates, normals, colours and confidence.
#pragma once

#include "io/source.h"
#include "io/table.h"

#include <memory>

namespace g3r::io {

/// Names of the properties that make up a cloud, in the dialects of PLY and PCD. npos where there is none.
struct Roles {
  std::size_t position[3];
  std::size_t normal[3];
  std::size_t color[3];
  std::size_t packed_color;  ///< PCD's "rgb" or "rgba"
  std::size_t confidence;
};

/// Finds the roles. A role that needs three properties is given only if all three are there and none is a list or an array.
Roles find_roles(const Element& points);

/// Fills positions, normals, colours, confidence and names from the table, which the cloud then holds.
/// Throws InvalidInput if x, y or z is missing or a list. Normals that are all zero are left out, with a warning.
void fill_cloud(const Source& source, std::shared_ptr<const Attributes> table, Cloud& cloud);

}  // namespace g3r::io
