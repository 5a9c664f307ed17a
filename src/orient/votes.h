// What hints say of the side of single points.
#pragma once

#include "cloud/neighbours.h"

#include <g3r/hints.h>
#include <g3r/points.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace g3r {

/// Votes on one side, of points that are turned together.
struct Votes {
  double in_favour = 0;
  double against = 0;
  double trusted = 0;  ///< sum over the points, of how far what they are seen by is (Voters::trusted())
  std::size_t points = 0;

  /// `vote`: above 0 in favour, below 0 against.
  void add(double vote) {
    in_favour += std::max(vote, 0.0);
    against += std::max(-vote, 0.0);
  }
  [[nodiscard]] double total() const { return in_favour + against; }
  /// Whether they are more than rounding, which is all that votes on points that are seen edge-on.
  [[nodiscard]] bool say_something() const { return total() > std::numeric_limits<float>::epsilon() * static_cast<double>(points); }
  [[nodiscard]] double share_against() const { return total() > 0 ? against / total() : 0; }
  /// Chance that the other side is right: a half so far as they are not trusted.
  [[nodiscard]] double chance_against() const { return 0.5 + (share_against() - 0.5) * trusted / static_cast<double>(points); }
};

/// Cosine under which a place sees the front of a point; 0 from the point itself.
[[nodiscard]] double seen_from(const Vec3& place, const Vec3& point, const Vec3& normal);

/// The nearest sensors that vote on a point, at most: of a path with thousands those farther away say little, and cost time.
inline constexpr std::size_t kMostSensors = 16;

/// The nearest of a few places, nearest first.
class NearestPlaces {
 public:
  /// `places` are kept by reference.
  explicit NearestPlaces(const std::vector<Vec3>& places);

  /// To a point, `most` of them or all.
  void find(const Vec3& point, std::size_t most);
  [[nodiscard]] std::size_t count() const { return index_.size(); }
  [[nodiscard]] const Vec3& place(std::size_t k) const { return places_[index_[k]]; }
  [[nodiscard]] double squared_distance(std::size_t k) const { return squared_[k]; }

 private:
  const std::vector<Vec3>& places_;
  std::optional<Neighbours> neighbours_;
  std::vector<std::uint32_t> index_;
  std::vector<double> squared_;
};

/// Votes of single points p with normals n, which count by how squarely a point is seen, and not by how near it is:
///   sensor s:  n . (s - p) / |s - p|      up u:  n . u / |u|      inside q:  - n . (q - p) / |q - p|
/// s is the sensor of the point if that is known, and q the nearest place. Else any of the sensors may have seen it: of the 16 nearest the
/// votes are averaged with weights 1 / |s - p|^2, as a scanner samples a surface the denser the nearer it is. `seen_from_inside` without
/// sensors votes like a sensor in the mean of the points. Votes of sensors count as far as those are trusted.
class Voters {
 public:
  /// `trusted`: of every sensor (SensorTrust); empty: 1. All are kept by reference.
  Voters(const std::vector<Vec3>& points, const Hints& hints, const std::vector<double>& trusted);

  /// How far what sensors say of point i is trusted, 0..1; 1 where none say anything.
  [[nodiscard]] double trusted(std::size_t i) const;

  /// What a sensor, or the middle that stands for one, says of point i with this normal.
  [[nodiscard]] double seen(std::size_t i, const Vec3& normal);

  /// Whether a middle stands for the sensors: where most of a scene is seen from, which tells nothing of what stands in it.
  [[nodiscard]] bool only_from_middle() const { return middle_ && !up_ && hints_.inside.empty(); }

  /// What all hints say of it together.
  [[nodiscard]] double vote(std::size_t i, const Vec3& normal);

 private:
  const std::vector<Vec3>& points_;
  const Hints& hints_;
  const std::vector<double>& trusted_;
  NearestPlaces sensors_;
  NearestPlaces inside_;
  std::optional<Vec3> up_;
  std::optional<Vec3> middle_;
};

}  // namespace g3r
