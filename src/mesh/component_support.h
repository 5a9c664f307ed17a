// What holds the components of a mesh, and which of them stay: one law for meshes in core and in tiles.
#pragma once

#include <g3r/g3r.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// What holds a component. Of parts that turn out to be one component the sums are those of the parts.
struct Support {
  double area = 0;                    ///< of its surface
  double near_area = 0;               ///< of that within kFarSpacings of a point, of the cloud where the point is isolated
  double stands_for = 0;              ///< points that its area stands for
  double stands_for_under_noise = 0;  ///< the same where noise makes spurious components
  double strays = 0;                  ///< beside it: within kFarSpacings of its points
  double points = 0;                  ///< that lie at it

  void add(const Support& other);
};

/// The N points of a cloud that may hold surface, N > 0, kept by reference.
struct HoldingPoints {
  const std::vector<Vec3>& positions;
  const std::vector<double>& spacing;  ///< N, in the unit of the positions
  double scatter;                      ///< standard deviation of the points about the surface, the same unit
};

/// Adds the triangles t to support[component[t]], all but its strays and points. O(F log N).
void add_areas(const Mesh& mesh, const std::vector<std::uint32_t>& component, const HoldingPoints& points, std::vector<Support>& support);

/// Adds the points and the strays (points that no surface goes through, none of them among the points). O((F + N) log F).
void add_points(const Mesh& mesh, const std::vector<std::uint32_t>& component, const HoldingPoints& points, const std::vector<Vec3>& strays,
                std::vector<Support>& support);

/// Points that the mesh is not the surface of, as shares of all.
struct Unmet {
  double bare = 0;    ///< no surface is within kFarSpacings of their spacings, and of `scatter`
  double turned = 0;  ///< the nearest faces away from their normals
};
/// `normals`: of the points, unit, outward as the triangles are. O((F + N) log F).
[[nodiscard]] Unmet unmet_points(const Mesh& mesh, const HoldingPoints& points, const std::vector<Vec3>& normals);

/// Marks (1) the components that stay. The one with most area near points always does. Of the others go, and are added to `dropped`,
/// spurious ones (MeshOptions::min_component), those that no point is near, those that fewer points hold than
/// least_points_of_a_part(strays), and those that fewer points hold than strays are beside them, as in a cloud that fills space; and those
/// beyond MeshOptions::keep_largest.
[[nodiscard]] std::vector<std::uint8_t> kept_components(const std::vector<Support>& support, const MeshOptions& options, std::size_t strays,
                                                        Dropped& dropped);

}  // namespace g3r::mesh
