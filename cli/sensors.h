// Where the scanner stood, as files say it.
#pragma once

#include <g3r/g3r.h>
#include <g3r/io.h>

#include "settings.h"

namespace g3r::cli {

/// The options, with the sensors of the file as a hint where they are asked for. Throws InvalidInput if the file names none.
[[nodiscard]] Options with_sensors(const Settings& settings, const Cloud& cloud);

/// Adds a warning where the side of open sheets could follow from the scanner positions of the file and no hint was given.
void mention_sensors(const Cloud& cloud, Stats& stats);

}  // namespace g3r::cli
