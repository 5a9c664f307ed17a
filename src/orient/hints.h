// Sides that the points leave open, decided by what people know.
#pragma once

#include <g3r/hints.h>
#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace g3r {

/// The parts of a cloud that are turned as a whole.
struct Patches {
  static constexpr std::uint32_t kNone = UINT32_MAX;
  std::vector<std::uint32_t> of;        ///< N: number of the patch a point belongs to, or kNone: it lies on a closed part; empty: all do
  std::vector<std::uint8_t> is_choice;  ///< N: not 0 where nothing tells the side of the patch; empty: nowhere
  std::vector<float> agreed;            ///< N, 0..1: how far the side of a point is that of its patch; empty: everywhere
  bool seen = false;                    ///< sensors that are known have seen all points, each from the front
};

/// Points with their sides, in canonical order.
struct SidedPoints {
  std::vector<Vec3>& normals;      ///< N unit vectors
  std::vector<Vec3>& eta;          ///< N area vectors
  std::vector<float>& confidence;  ///< N
};

struct HintEffect {
  std::vector<std::uint8_t> decided;  ///< N: on a patch whose side was a choice and is none now; empty: nowhere
  std::vector<std::uint8_t> turned;   ///< N: by a vote or an order, not counting `flip`; empty: nowhere
  double agreement = 0;               ///< share of the votes on decided patches that agree with the side they got; 0: none was decided
  double contradicted_share = 0;      ///< share of the votes on closed parts that were against their side; 0 if too few to matter
  bool closed_parts_turned = false;   ///< `contradicted_share` is that from before
  std::optional<Vec3> inside_that_is_outside;  ///< of Hints::inside, one that no closed part encloses although there are such parts
};

/// Follows the hints, given in the coordinates of the points, `sensor_of_point` in their order. A patch takes the side that most of its
/// votes are for, a vote of point p being
///   sensor s:  n . (s - p) / |s - p|      up u:  n . u / |u|      inside q:  - n . (q - p) / |q - p|
/// so that a point counts by how squarely it is seen, and not by how near it is; `seen_from_inside` without sensors votes like a sensor in
/// the mean of the points. A patch that is seen edge-on but for rounding keeps its side. Where the side was a choice the confidence becomes
/// the share of the votes that agree, times `agreed`, and two thirds decide it; elsewhere it takes two thirds to turn a patch. Then pieces
/// of a patch that are not consistent with the rest of it are turned by two thirds of their own votes: what a gap separates has no other
/// way to agree. A piece ends too where adjacent points object to each other more than at a horizon, and what hangs together with it by a
/// few pairs of points only, as in a crevice, is turned by itself. What of open parts still faces away from all sensors that may have seen
/// it, at a cosine v < 0, has a confidence of (1 + v) / 2 at most; where all points have been `seen`, what would be seen squarely from
/// behind is turned, with (1 - v) / 2. Closed parts have one side: they are turned by `seen_from_inside` and by sensors inside them, where
/// the winding number of `eta` is 1/4 and more (outside it is 0, however near or far), or, if the sensor of each point is known, by two
/// thirds of the votes. `near`: Neighbours::of_all(k), or empty: patches have no pieces; `spacing`: of the points, for the winding number.
/// O(N log(sensors) + N k), O(N) for each of at most 500 sensors, and all sensors for each open point that none of them sees from the
/// front. Throws Cancelled.
[[nodiscard]] HintEffect follow_hints(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near, double spacing,
                                      const Patches& patches, const Hints& hints, const SidedPoints& sided,
                                      const std::atomic<bool>* cancel = nullptr);

/// Throws InvalidInput for hints that cannot be meant for `count` points: a vector that is not finite, a direction of no length, a number
/// of a sensor that there is not.
void require_sound(const Hints& hints, std::size_t count);

}  // namespace g3r
