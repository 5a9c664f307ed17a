// The spacing of a cloud that passes by, before anything of it is known.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace g3r::tiles {

/// Keeps some of the points, each with the same chance, whatever their number: a hash of its place in the order decides. 3 MiB.
class SpacingSample {
 public:
  void add(const Vec3& point);
  /// Typical spacing of all points that were added, as if they were scattered over a surface: that of the sample, scaled by the numbers.
  /// 0 if there are too few to tell, or most are in one place. O(sample log sample).
  [[nodiscard]] double spacing() const;

 private:
  std::vector<std::pair<std::uint64_t, Vec3>> kept_;  // with their hashes
  std::uint64_t count_ = 0;
  int halvings_ = 0;  // hashes of those that are kept begin with so many zeros
};

}  // namespace g3r::tiles
