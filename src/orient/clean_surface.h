// The normals of clean points, which prove what their surface is.
#pragma once

#include "base/stages.h"
#include "orient/problem.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// The directions of a clean cloud, from jets (fit_jets()) and planes (fit_planes()), where its points prove what the surface is. Sides
/// stay. Returns for which points they do. `normals`: N unit vectors. O(N).
std::vector<std::uint8_t> fit_directions(const Problem& problem, std::vector<Vec3>& normals);

/// The normals of a clean cloud whose parts are closed: directions, the sides of facets, and directions beside creases. Where a thousandth
/// of the points (kMinMinority) is on another side than most of its facet, every facet gets one (choose_facet_sides()), and the other
/// points their normals from the field of what the facets have become, up to three times; fewer are turned one by one
/// (turn_single_points()). Then facets are followed up to their edges
/// (follow_facets()), and jets up to their creases (fit_jets_at_creases()). `eta`, `normals`: in and out. Throws Cancelled.
void fit_clean_surface(const Problem& problem, std::vector<Vec3>& eta, std::vector<Vec3>& normals, Stages& stages);

}  // namespace g3r
