// Clouds of any size, for python/g3r/tiles.py.
#pragma once

#include <nanobind/nanobind.h>

namespace g3r::python {

/// Adds tiles_plan, tiles_run, tiles_status and tiles_merge to the module.
void bind_tiles(nanobind::module_& m);

}  // namespace g3r::python
