// Where the scanner stood, as files say it.
#pragma once

#include <g3r/g3r.h>
#include <g3r/io.h>

#include <vector>

#include "settings.h"

namespace g3r::cli {

/// The options, with the sensors of the file as a hint where they are asked for, and with the memory that is free as its limit where none
/// is given. Throws InvalidInput if the file names no sensors.
[[nodiscard]] Options run_options(const Settings& settings, const Cloud& cloud);

/// Adds a warning where the scanner positions of the file would say more than the points and no hint was given: open surfaces, and a cloud
/// that surrounds its scanner, most of whose normals face away from it.
void mention_sensors(const Cloud& cloud, const std::vector<Vec3>& normals, Stats& stats);

}  // namespace g3r::cli
