// What a run came to, in about six lines.
#pragma once

#include <g3r/g3r.h>

#include "session.h"
#include "settings.h"

namespace g3r::cli {

/// Ends a run: completes the statistics, shows warnings and summary, writes the report. `mesh` may be null. Returns the exit code: kOk, or
/// with --strict kBadData for a doubtful result (not converged, not consistent, doubtful, a mesh that is not closed).
[[nodiscard]] int finish(const Settings& settings, Session& session, Stats stats, const MeshCheck* mesh);

}  // namespace g3r::cli
