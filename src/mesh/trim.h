// Surface that nobody measured, cut away.
#pragma once

#include "mesh/constants.h"

#include <g3r/g3r.h>

#include <vector>

namespace g3r::mesh {

/// Removes triangles that reach farther from every point than `trim_distance`, or (auto) than 4 spacings: of the cloud, or of the place
/// where that is denser; 1.4 of the place where it is so sparse that this is more. What spans gaps stays so, but at the rims of an open
/// scan surface goes on as far for nothing: from there inwards (auto) what is farther than 1.2 spacings (spacing_across_lines) goes too,
/// and then triangles that hang on by one edge; the rims that are left are smoothed (smooth_rims), within the same distances. Nothing
/// happens to surface that is nowhere too far. `spacing`: of each point. O(F log N). Throws InvalidInput if nothing would be left.
void trim(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& spacing, const MeshOptions& options);

}  // namespace g3r::mesh
