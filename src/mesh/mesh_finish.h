// What is done to a closed mesh before it is returned or simplified: trimming, dropping components.
#pragma once

#include "mesh/field_local_fit.h"

#include <g3r/g3r.h>

#include <atomic>
#include <vector>

namespace g3r::mesh {

/// What was left out for want of support.
struct LeftOut {
  std::vector<Vec3> strays;  ///< places of points that no surface goes through
  Dropped dropped;
};

/// Share of the mesh's area whose triangles have their centre farther than `spacings` local spacings, of points in lines those across
/// the lines, from every point. Not of simplified meshes, whose triangles are larger. O((F + N) log N).
[[nodiscard]] double far_share(const Mesh& mesh, const std::vector<Vec3>& points, double spacings);

/// Trims and drops components as the options ask; `trim_distance` is in the units of the mesh. A closed 2-manifold stays
/// closed unless trimmed, and 2-manifold always. Throws InvalidInput if an option is out of range or nothing would be left; Cancelled.
/// `noise`: standard deviation of the points about the surface, in spacings; `left_out`: the points
/// that were left out before, to which the components that kept_components() leaves out are added.
void finish_mesh(Mesh& mesh, const OrientedPoints& points, double noise, const MeshOptions& options, LeftOut& left_out,
                 const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
