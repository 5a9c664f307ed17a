// Sides that the points leave open, decided by what people know.
#pragma once

#include <g3r/hints.h>
#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace g3r {

/// The parts of a cloud that are turned as a whole.
struct Patches {
  static constexpr std::uint32_t kNone = UINT32_MAX;
  std::vector<std::uint32_t> of;  ///< N: number of the patch a point belongs to, or kNone: it lies on a closed part; empty: all do
  std::vector<float> certainty;   ///< N, 1/2..1: of the side of the patch; below 1 it is a choice; empty: 1
  std::vector<float> agreed;      ///< N, 0..1: how far the side of a point is that of its patch; empty: everywhere
  std::vector<float> held;        ///< N: the chance that a point has the side of the rest of its patch; empty: 1
  bool seen = false;              ///< sensors that are known have seen all points, each from the front

  /// Whether point i lies on a closed part.
  [[nodiscard]] bool is_closed(std::size_t i) const { return of.empty() || of[i] == kNone; }
};

/// Points with their sides, in canonical order.
struct SidedPoints {
  std::vector<Vec3>& normals;      ///< N unit vectors
  std::vector<Vec3>& eta;          ///< N area vectors
  std::vector<float>& confidence;  ///< N
};

/// What hints are followed for: points, their Neighbours::of_all(k) (empty: patches have no pieces), their spacing, for the winding number,
/// and what is known of their sides and their sensors.
struct HintedCloud {
  const std::vector<Vec3>& points;
  const std::vector<std::uint32_t>& near;
  double spacing;
  const Patches& patches;
  const Hints& hints;
  SidedPoints sided;
  std::vector<double> trusted{};            ///< how far each sensor is (SensorTrust); empty: 1
  std::vector<std::uint8_t> over_others{};  ///< over_others() along `up`, which says less of the side of these; empty: none is
};

/// What follow_hints() has done.
struct HintEffect {
  std::vector<std::uint8_t> decided;  ///< N: of points whose side was a choice and is none now; empty: nowhere
  std::vector<std::uint8_t> turned;   ///< N: by a vote or an order, not counting `flip`; empty: nowhere
  double agreement = 0;               ///< share of the votes on decided patches that agree with the side they got; 0: none was decided
  double contradicted_share = 0;      ///< share of the votes on closed parts that were against their side; 0 if too few to matter
  bool closed_parts_turned = false;   ///< `contradicted_share` is that from before
  std::optional<std::size_t>
      inside_that_is_outside;  ///< index in Hints::inside of one that no closed part encloses, if there are such parts
};

/// Follows the hints of a cloud, given in the coordinates of its points, `sensor_of_point` in their order: patches take the side that most
/// of the votes of their points are for (decide_patches()), where a place inside a closed part has no vote, and closed parts, which have
/// one side, are turned where they surround the sensors (judge_closed_parts()). Then turns the normals and area vectors of the points that
/// this turns, and by `flip` those of all others instead. O(N log(sensors) + N k), O(N) for each of at most 500 sensors, and all sensors
/// for each open point that none of them sees from the front. Throws Cancelled.
[[nodiscard]] HintEffect follow_hints(const HintedCloud& cloud, const std::atomic<bool>* cancel = nullptr);

/// The names of the hints that are given, as reports have them.
[[nodiscard]] std::vector<std::string> names_of(const Hints& hints);

/// Throws InvalidInput for hints that cannot be meant for `count` points: a vector that is not finite, a direction of no length, a number
/// of a sensor that there is not.
void require_sound(const Hints& hints, std::size_t count);

}  // namespace g3r
