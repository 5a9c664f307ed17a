// The spacing of a cloud that passes by, before anything of it is known.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>

namespace g3r::tiles {

/// Keeps some of the places of the points, each with the same chance, whatever their number: a hash of the coordinates decides, so that
/// neither the order of the points nor how often one is repeated matters. 10 MiB.
class SpacingSample {
 public:
  void add(const Vec3& point);
  /// Typical spacing of all places that were added, as if they were scattered over a surface: that of the sample, scaled by the share that
  /// is kept. 0 if there are too few to tell. O(sample log sample).
  [[nodiscard]] double spacing() const;

 private:
  std::map<std::uint64_t, Vec3> kept_;                              // by their hashes, so that their order is always the same
  std::uint64_t last_ = std::numeric_limits<std::uint64_t>::max();  // hash that is kept
  int halvings_ = 0;                                                // of the hashes that are kept
};

}  // namespace g3r::tiles
