// Gaussian splats as the 3DGS training code exports them: a PLY whose vertices have f_dc_0..2 and opacity.
// Source: Kerbl, Kopanas, Leimkuehler, Drettakis, "3D Gaussian Splatting", 2023 (opacity behind a sigmoid, colour as degree-0 harmonic).
#pragma once

#include "io/source.h"
#include "io/table.h"

#include <memory>

namespace g3r::io {

/// Whether the vertices are splats.
bool is_splat(const Element& points);

/// Fills the cloud from a table of splats; colours are 0.5 + Y_0 f_dc. Left out, with a warning that says how many and how to keep them,
/// are
///   - those whose opacity, 1 / (1 + exp(-value)), is below options.min_opacity;
///   - where the table has scale_0..2 (logarithms) and rot_0..3 (a quaternion, w first), those that places_of() finds translucent or
///   hidden.
/// All are kept with options.all_splats, and where none would be left. Throws as fill_cloud(), and Cancelled.
void fill_splat_cloud(const Source& source, std::shared_ptr<Attributes> table, const ReadOptions& options, Cloud& cloud);

}  // namespace g3r::io
