// Part of a cloud: the points within a box.
#pragma once

#include "io/table.h"

#include <string>
#include <string_view>

namespace g3r::io {

/// Leaves out the points outside of the box, of which the surface counts, and those that are not finite. Of the table the points' records
/// remain; other elements, such as faces, which name points by number, are dropped.
void keep_box(Cloud& cloud, const Box& box);

/// Makes counts and bounds in the header of a LAS file those of its first `count` records.
void fit_las_header(std::string& las, std::uint64_t count);

}  // namespace g3r::io
