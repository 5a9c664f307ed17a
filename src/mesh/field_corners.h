// Which side of the surface the corners of an octree are on.
#pragma once

#include "mesh/field_local_fit.h"
#include "mesh/field_octree.h"
#include "mesh/field_sampler.h"
#include "mesh/side_smoothing.h"

#include <g3r/points.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace g3r::mesh {

/// |w - level| from which the field overrules the fitted surface: with 0.4 the sword has 44 handles instead of 5.
inline constexpr double kFieldSure = 0.2;

/// The corners of an octree.
struct Corners {
  std::vector<float> value;    ///< of each: positive inside, about minus the distance to the surface
  AmbiguousCorners ambiguous;  ///< of those that could be on either side
};

/// The cube that holds all points.
struct Cube {
  Vec3 centre{0, 0, 0};
  double side = 0;
};

/// Places at which the field is asked at once, of every point: each evaluation sums the points anew, so fewer take longer, and more memory.
inline constexpr std::size_t kAskedPerPoint = 2;

/// A positive value inside. Near the points it is minus the distance to the fitted surface, unless the field is sure of the contrary;
/// elsewhere it is the field, scaled to a length.
class CornerSides {
 public:
  /// `local` and `sampler` must outlive this. `typical`: spacing of the points; `places`: on the surface, where the median of the field is
  /// its level; `asked_at_once`: places whose field is asked at once, 0 for the least that is worth a sum.
  CornerSides(const LocalFit& local, const FieldSampler& sampler, double typical, const Cube& cube, const std::vector<Vec3>& places,
              std::size_t asked_at_once);

  /// Of the corners for which wanted(corner); the others are outside, and so is all that is beyond the cube of side 2 in a frame in which
  /// that of the points is kBoxSide long. Throws Cancelled.
  [[nodiscard]] Corners of(const Octree& octree, const std::function<bool(std::uint32_t)>& wanted, const std::atomic<bool>* cancel) const;

 private:
  struct Place;
  static constexpr std::uint32_t kNotAmbiguous = std::numeric_limits<std::uint32_t>::max();
  struct Asked {
    std::uint32_t corner;
    std::uint32_t ambiguous;  // its place among the ambiguous ones, or kNotAmbiguous
    bool unjoined;            // the field decides, however unsure
  };

  [[nodiscard]] Place fit_at(const Vec3& at) const;
  void ask_field(const Octree& octree, const std::vector<Asked>& asked, Corners& corners) const;
  [[nodiscard]] bool is_beyond(const Vec3& x) const;

  const LocalFit& local_;
  const FieldSampler& sampler_;
  double spacing_;
  Cube cube_;
  std::size_t asked_at_once_;
  double reach_ = 0;  // half the side of the cube that everything inside is in
  double level_ = 0;  // of the field on the surface
};

/// By the fitted surface alone; outside where there is none: what is asked where signs can be joined in two ways.
[[nodiscard]] std::vector<std::uint8_t> sides_by_fit(const LocalFit& local, const std::vector<Vec3>& places);

/// Whether the points hold surface that crosses between two places: a fitted patch has the first one inside and the second outside.
[[nodiscard]] bool is_held(const LocalFit& local, const Vec3& inside, const Vec3& outside);

/// Where handles were removed `inside` is not the sign of the values: they become small ones of that side, as vertices are placed by them.
void match_values(const Octree& octree, const std::vector<std::uint8_t>& inside, double typical, std::vector<float>& value);

}  // namespace g3r::mesh
