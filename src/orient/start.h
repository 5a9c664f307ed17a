// orient() where something is known of the points and of their surface already.
#pragma once

#include <g3r/g3r.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// What is known of N points, in their order. Each may be empty: nothing is known.
struct Known {
  /// A winding gradient: vectors along the normals, their lengths in proportion. It takes the place of that of the solution on a quarter of
  /// the points, where the solve would begin with that (starts_coarse()); elsewhere it has no effect.
  std::vector<Vec3> gradient;
  /// How many times as far apart the points are as the densest ones, at least 1, where the cloud has been thinned more at some places than
  /// at others: the square root of the number of points that each one stands for. Kernels are as much wider there.
  std::vector<double> relative_spacing;
  /// 1 for each point whose normal is asked for; the others are its surroundings. Other noises and the sides of facets are tried where
  /// sides of these points are unsure, and only they have fits of noisy points; more steps of the solver go by all points.
  std::vector<std::uint8_t> wanted;
  /// 1 for each point that lies on a surface without an inside, whose side is that of the gradient; with a gradient only. The equations,
  /// which are not true there, are not solved for these points, and no other sides are tried.
  std::vector<std::uint8_t> open;
};

/// orient(points, options, monitor) with what is known. `open`: unless null, becomes 1 for each point that lies on a surface without an
/// inside, whose side is a choice of all of them together, and 0 for others. src/pipeline.cpp.
[[nodiscard]] Orientation orient_from(const PointsView& points, Known known, const Options& options, const Monitor& monitor,
                                      std::vector<std::uint8_t>* open = nullptr);

/// plan(points, options) that can be cancelled. Throws Cancelled. src/pipeline.cpp.
[[nodiscard]] Stats plan_of(const PointsView& points, const Options& options, const Monitor& monitor);

}  // namespace g3r
