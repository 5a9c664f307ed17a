// Gaussian splats as the 3DGS training code exports them: a PLY whose vertices have f_dc_0..2 and opacity.
// Source: Kerbl, Kopanas, Leimkuehler, Drettakis, "3D Gaussian Splatting", 2023 (opacity behind a sigmoid, colour as degree-0 harmonic).
#pragma once

#include "io/table.h"

#include <array>
#include <string>
#include <vector>

namespace g3r::io {

/// Whether the vertices are splats.
bool is_splat(const Element& points);

/// Leaves out the splats whose opacity, 1 / (1 + exp(-value)), is below `least` (0..1) and says how many.
/// When every splat is below it all are kept, with a warning.
void filter_splats(Attributes& table, double least, std::vector<std::string>& warnings);

/// RGB of every splat from f_dc: 0.5 + Y_0 f_dc.
std::vector<std::array<std::uint8_t, 3>> splat_colors(const Element& points);

}  // namespace g3r::io
