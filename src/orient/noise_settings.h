// What the settings of a noisy cloud follow from: one law of sigma / h for all noise (docs/math.md, "Widths and steps").
#pragma once

#include "orient/settings.h"

#include <g3r/g3r.h>

#include <cstddef>

namespace g3r {

/// Weight of the winding number in the polish of clean points and little noise, in h^3 (kWindingWeight): more costs sides, less costs
/// narrow gaps and smooth shapes.
inline constexpr double kPolishWindingWeight = 70;

/// The noise in spacings that kernels of this width, in spacings too, hide.
[[nodiscard]] double hidden_noise(double width);

/// The noise in spacings that asks for kernels no wider than those of clean clouds.
[[nodiscard]] double noise_of_clean_widths();

/// Changes widths, steps and the polish of the default for noise of this many spacings, above 0; none that `options` give. `points`: of the
/// cloud.
void follow_noise(double noise, const Options& options, std::size_t points, Settings& settings);

/// The same with a polish for noisy points that project_points() has moved onto the surface: for the noise that this leaves.
[[nodiscard]] Settings after_projection(const Settings& settings);

}  // namespace g3r
