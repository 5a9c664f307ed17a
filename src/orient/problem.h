// A cloud and options, resolved: what is solved for.
#pragma once

#include "base/stages.h"
#include "baselines/baseline.h"
#include "cloud/canonical_cloud.h"
#include "cloud/sites.h"
#include "orient/settings.h"
#include "orient/start.h"

#include <g3r/g3r.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace g3r {

/// What a solve starts from. Lengths are in the unit frame of the cloud.
struct Problem {
  CanonicalCloud cloud;
  std::vector<Vec3> outliers;      ///< taken out of the cloud; their indices follow those of its points
  std::size_t far = 0;             ///< of the caller's points, left out by far_points(), which outliers are too
  double outlier_share = 0;        ///< of the whole cloud; that of its parts, which are among its outliers, too
  double spacing = 0;              ///< typical_spacing()
  double noise = 0;                ///< given_noise() or estimate_noise()
  double direction_noise = 0;      ///< the largest that directions follow, each its place's: find_sight_noise() where Views are known, or
                                   ///< largest_scatter(); without noise that kernels have to hide, fine_noise()
  std::size_t noise_together = 1;  ///< SightNoise::together
  double scatter = 0;              ///< facet_scatter(), where planes are fitted
  std::vector<double> line_distance;  ///< surface_distances(): N, of the sites that lines are solved for on, 0 elsewhere; empty: no lines
  Known known;                        ///< of the points of the cloud, in its order
  Settings settings;

  /// Whether the points are exact, so that steps follow the local spacing and prove directions from the points alone.
  [[nodiscard]] bool is_clean() const { return noise == 0 && !contains(settings.without, Step::kPolish); }
  /// Whether all of the samples are lines.
  [[nodiscard]] bool is_lines() const {
    return !line_distance.empty() && std::find(line_distance.begin(), line_distance.end(), 0.0) == line_distance.end();
  }
  /// Whether the areas that are returned come from the spacing: the solve is for normals, and the lengths of its vectors vary with the
  /// sample. Earlier methods keep theirs.
  [[nodiscard]] bool replaces_areas() const { return !contains(settings.without, Step::kAreas); }
  std::optional<BaselineSettings> baseline;  ///< with the methods wnnc, agr and pgr
};

/// Whether a step is not left out.
[[nodiscard]] inline bool runs(const Problem& problem, Step step) { return !contains(problem.settings.without, step); }

/// Which sensor has seen each point of the cloud, from what the caller says of all; of duplicates the one with the smallest number,
/// kNoSensor if none is known.
[[nodiscard]] std::vector<std::uint32_t> sensors_of_points(const CanonicalCloud& cloud, const std::vector<std::uint32_t>& sensor_of_point);

/// How many times as far apart the points are as typical ones, 1 at least, or narrowing() where they crowd; kernels are as much wider.
/// Unless the width is given: then only as far as they have been thinned. Empty: nowhere. O(N).
[[nodiscard]] std::vector<double> relative_spacing(const Problem& problem, const Options& options);

/// Canonical order, outliers, spacing, noise and settings of a cloud; `known`: in the order of `points`. Throws InvalidInput for a cloud or
/// an option out of range, Cancelled. O(N log N).
[[nodiscard]] Problem prepare(const PointsView& points, Known known, const Options& options, Stages& stages);

/// The same problem with this noise instead of the estimate.
[[nodiscard]] Problem with_noise(const Problem& problem, double noise, const Options& options);

/// The same problem on some of its points (ascending indices), with a spacing and settings of their own.
[[nodiscard]] Problem part_of(const Problem& problem, const std::vector<std::uint32_t>& some, const Options& options);

/// The problem on the sites of its cloud, with their spacing and noise, and settings of their own.
[[nodiscard]] Problem on_sites(const Problem& problem, const Sites& sites, const Options& options);

}  // namespace g3r
