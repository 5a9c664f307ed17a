// What the field mesher makes of a cloud before anything else: the points that its fits see, and the discs that its octree resolves.
#pragma once

#include "cloud/neighbours.h"
#include "mesh/constants.h"
#include "mesh/field_denoise.h"
#include "mesh/field_local_fit.h"
#include "mesh/field_octree.h"

#include <g3r/g3r.h>
#include <g3r/names.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r::mesh {

/// The level of the largest leaves: 16 along each axis, so that coarse places of the field are seen too.
inline constexpr int kBaseLevel = kLeastMeshDepth;

/// What the fits see of the cloud.
struct Prepared {
  OrientedPoints points;                         ///< positions that scatter are moved onto the surface they scatter about
  std::unique_ptr<const Neighbours> neighbours;  ///< of these positions
  std::vector<std::uint32_t> near;               ///< of_all(k) with the k of find_neighbours()
  double typical = 0;                            ///< spacing of the cloud
  double noise = 0;                              ///< noise_seen() of the positions as they came
};

/// In place: the neighbours refer to the positions.
void find_neighbours(Prepared& prepared);

/// Fills in points, neighbours and spacings. `typical`: spacing of the cloud that these points are a part of; 0: theirs. Throws
/// InvalidInput (a normal is zero, all points are at one place).
void prepare(const std::vector<Vec3>& points, std::vector<Vec3> normals, double typical, Prepared& prepared);

/// Of the positions, in typical spacings; 0 where it is too little to tell.
[[nodiscard]] double noise_seen(const Noise& noise);

/// Moves points that scatter more than a fit bears. Throws Cancelled.
void smooth_noise(const Noise& noise, const std::atomic<bool>* cancel, Prepared& prepared);

/// The side of the leaves around points, in typical spacings, under noise_seen(): half of the width of the fits that points move onto,
/// where this is more than without noise. What fits smooth away needs no leaves, and with finer ones it comes back as handles.
[[nodiscard]] double cell_under(double noise);

/// For HandleRemoval, with leaves of such a side in spacings: as many corners as without noise, in what is to the width of the fits as
/// those are to kFinestCell.
[[nodiscard]] double most_per_handle(double noise, double cell);

/// The size of what is to be seen at each point: its spacing, or less where walls and gaps are thinner. `in_lines`: of points_in_lines(),
/// which are no walls to each other unless so few points are a line by chance; may be empty.
[[nodiscard]] std::vector<double> sizes_to_resolve(const Prepared& prepared, const std::vector<std::uint8_t>& in_lines = {});

/// Levels of leaves around points.
struct LevelRule {
  double typical = 0;   ///< spacing,
  int finest = 0;       ///< and the level whose cells have the side that was asked for, or less
  bool deepens = true;  ///< dense sampling and walls may add levels
};
/// The disc around a point that leaves resolve. `size`: of sizes_to_resolve().
[[nodiscard]] RefineDisc disc_around(const Vec3& position, const Vec3& normal, double spacing, double size, const LevelRule& rule);

/// Of the points, or evenly many of them: the median of the field there is its level on the surface.
[[nodiscard]] std::vector<Vec3> level_places(const std::vector<Vec3>& points);

}  // namespace g3r::mesh
