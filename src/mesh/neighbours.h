// Nearest points: a k-d tree over positions. The only mesher file that names nanoflann is neighbours.cpp.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r::mesh {

class Neighbours {
 public:
  /// `positions` must outlive this. O(N log N).
  explicit Neighbours(const std::vector<Vec3>& positions);
  ~Neighbours();
  Neighbours(const Neighbours&) = delete;
  Neighbours& operator=(const Neighbours&) = delete;

  /// The min(k, N) points nearest to x, nearest first, and their squared distances. O(k log N).
  void nearest(const Vec3& x, std::size_t k, std::vector<std::uint32_t>& index, std::vector<double>& squared) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// The median of h_j = d_8 sqrt(pi / 8) over each point and its 8 neighbours, in input units: less ragged than the spacing of single
/// points, which random sampling scatters, and not led astray by a lone outlier. O(N log N).
[[nodiscard]] std::vector<double> smooth_spacing(const std::vector<Vec3>& positions);

}  // namespace g3r::mesh
