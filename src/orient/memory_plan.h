// The memory that orient() takes, known before the solve.
#pragma once

#include "orient/settings.h"

#include <g3r/g3r.h>

#include <cstddef>

namespace g3r {

/// Predicted peak memory of orient() in bytes: `given` points, of which `used` are distinct and no outliers. Measured
/// peaks are 0.9 to 1.08 of it, but for clouds whose facets are solved for, 1.25 (docs/evidence/speed.md), and clean ones that are open,
/// which is not known before the solve, 1.2 to 1.35.
[[nodiscard]] std::size_t planned_memory(const Settings& settings, std::size_t given, std::size_t used);

/// Throws Unavailable if the plan, with that of a mesh where one is made, exceeds the limit, 0: none.
void require_memory(std::size_t planned_bytes, std::size_t limit, bool makes_mesh);

}  // namespace g3r
