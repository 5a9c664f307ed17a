// What is done to a closed mesh before it is returned or simplified: trimming, dropping components.
#pragma once

#include "mesh/field_local_fit.h"

#include <g3r/g3r.h>

#include <atomic>
#include <vector>

namespace g3r::mesh {

/// What is found out while a mesh is made.
struct Found {
  std::vector<Vec3> strays;   ///< places of points that no surface goes through
  Dropped dropped;            ///< for want of support
  double noise = 0;           ///< standard deviation of the points that is smoothed over, a length
  double pointless_area = 0;  ///< share of the area that is of parts which no point holds
  bool trimmed = false;       ///< whether trimming cut something off, of parts that were dropped after it too
};

/// Share of the mesh's area whose triangles have their centre farther than `spacings` local spacings, of points in lines those across
/// the lines, from every point. Not of simplified meshes, whose triangles are larger. O((F + N) log N).
[[nodiscard]] double far_share(const Mesh& mesh, const std::vector<Vec3>& points, double spacings);

/// Trims and drops components as the options ask; `trim_distance` is in the units of the mesh. A closed 2-manifold stays
/// closed unless trimmed, and 2-manifold always. Throws InvalidInput if an option is out of range or nothing would be left; Cancelled.
/// `noise`: standard deviation of the points about the surface, in spacings; `found`: the points that were left out before, to which the
/// rest is added.
void finish_mesh(Mesh& mesh, const OrientedPoints& points, double noise, const MeshOptions& options, Found& found,
                 const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
