// Points in canonical order, and what the steps ask of them.
#pragma once

#include "cloud/neighbours.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r {

/// Where sensors have seen points from, each from the front and with nothing before it.
struct Views {
  std::vector<Vec3> places;             ///< empty: not known
  std::vector<std::uint32_t> of_point;  ///< N indices into `places`; empty: all points have been seen from the first

  [[nodiscard]] bool known() const { return !places.empty(); }
  /// Whether all points have been seen from one place.
  [[nodiscard]] bool is_one() const { return known() && of_point.empty(); }
  /// Where a point has been seen from, if that is known.
  [[nodiscard]] const Vec3& place_of(std::size_t point) const { return places[of_point.empty() ? 0 : of_point[point]]; }
};

/// Distinct points in canonical order, and what is known of their surroundings: each made on first use and handed on as one thing.
/// Copies share it. Not to be asked from within a parallel loop for what has not been made.
class PointSet {
 public:
  PointSet();  ///< no points
  /// `points`: in the unit frame, as a rule.
  explicit PointSet(std::vector<Vec3> points, Views views = {});

  [[nodiscard]] const std::vector<Vec3>& points() const;  ///< N
  [[nodiscard]] std::size_t size() const { return points().size(); }

  /// The k-d tree. O(N log N).
  [[nodiscard]] const Neighbours& tree() const;
  /// Of every point the near_count() nearest, nearest first (itself, but for points in the same place): N x near_count(), row-major.
  /// O(N log N).
  [[nodiscard]] const std::vector<std::uint32_t>& near() const;
  [[nodiscard]] std::size_t near_count() const;  ///< min(kSpacingNeighbours, N)
  /// local_spacing(), smoothed_spacing() and typical_spacing() of the points.
  [[nodiscard]] const std::vector<double>& local_spacing() const;
  [[nodiscard]] const std::vector<double>& smoothed_spacing() const;
  [[nodiscard]] double spacing() const;
  /// rounding_steps() of the points.
  [[nodiscard]] const Vec3& rounding_steps() const;

  /// Not known unless they have been told, in the frame of the points.
  [[nodiscard]] const Views& views() const;
  void set_views(Views views);

  /// Gives back tree(), near() and local_spacing(), a quarter of what a solve takes; references to them end. They are made again when they
  /// are asked for.
  void release_neighbours() const;

 private:
  struct Known;
  std::shared_ptr<Known> known_;
};

}  // namespace g3r
