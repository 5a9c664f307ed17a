// What people know of a cloud and its points cannot say: which way is up, where the scanner stood, what is inside.
#pragma once

#include <g3r/export.h>
#include <g3r/points.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace G3R_PUBLIC g3r {

/// Hints::sensor_of_point of a point that no sensor is known of.
inline constexpr std::uint32_t kNoSensor = 0xffffffff;

/// Hints for orient(); all are optional. They vote where the points leave the side open - on every open surface as a whole, each point with
/// the cosine under which it is seen - and decide it with the share of the votes that agree as its confidence; less where a point hardly
/// hangs together with the rest of its surface and is seen edge-on, as a wall is from above. The sides of closed parts follow from the
/// points; a hint that contradicts them is a warning with its share. Two hints do turn closed parts: `seen_from_inside`, and a sensor
/// inside a closed part, from which nobody could have seen its outside; of the latter a warning tells.
struct Hints {
  /// Direction, of any length, that open surfaces face: terrain, roofs, what lies on a table. Alone it decides what lies over other points,
  /// as canopies and decks do, with a confidence of two thirds at most: it may have been seen from below.
  std::optional<Vec3> up{};
  /// Places that the points were seen from, all of them. A point faces its own sensor; if `sensor_of_point` is empty, each may have seen
  /// it, and near ones are likelier (src/orient/votes.h).
  std::vector<Vec3> sensors{};
  /// Empty, or for every point an index into `sensors`, or kNoSensor.
  std::vector<std::uint32_t> sensor_of_point{};
  /// Points inside the solid: open surfaces face away from the nearest one that no closed part encloses.
  std::vector<Vec3> inside{};
  /// Rooms, tunnels, streets: normals face the side the scanner was on, which is that of `sensors`, without them the place of a camera that
  /// the points show (HintStats::viewpoint), or else the middle of the cloud. Closed parts that enclose a sensor, or span half of the cloud
  /// along every axis, are turned too; what they surround keeps facing it.
  bool seen_from_inside = false;
  /// Turns every normal, after all other hints.
  bool flip = false;
};

/// What the hints did. Shares of all points that were used, 0..1.
struct HintStats {
  std::vector<std::string> given;  ///< of "up", "sensor", "inside", "seen_from_inside", "flip"
  double settled_share = 0;        ///< a hint decides their side, which was a choice, or what has seen them all, whatever it was
  double turned_share = 0;         ///< turned by a hint, flip included, or to face what has seen all
  double agreement = 0;            ///< share of the votes on decided parts that agree with the side they got; 0 if none was
  /// The place from which one camera or scanner has seen all points: of depth frames, as the lines of sight show (rows and columns of
  /// pixels), or a single sensor that was given, where nothing hides anything from there. Every point faces it unless `up` or `inside`
  /// say otherwise.
  std::optional<Vec3> viewpoint{};
  /// Share of what sensors should have seen of open surfaces that other points hide from them: a side is trusted with the rest as its
  /// chance. 0 where nothing is hidden or no sensor is given.
  double hidden_share = 0;
  double contradicted_share = 0;  ///< share of the votes on closed parts that were against their side; 0 up to 1/3, which is usual
};

}  // namespace g3r
