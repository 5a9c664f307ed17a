// Nearest points: a k-d tree over positions.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r {

/// Of N points. Any number of threads may ask at once.
class Neighbours {
 public:
  /// `positions` must outlive this. O(N log N).
  explicit Neighbours(const std::vector<Vec3>& positions);
  ~Neighbours();
  Neighbours(const Neighbours&) = delete;
  Neighbours& operator=(const Neighbours&) = delete;

  /// The min(k, N) points nearest to x, nearest first, those as far by their index, and their squared distances. O(k log N).
  void nearest(const Vec3& x, std::size_t k, std::vector<std::uint32_t>& index, std::vector<double>& squared) const;
  /// The same among the points with a mark other than 0, one mark a point.
  void nearest_marked(const Vec3& x, std::size_t k, const std::vector<std::uint8_t>& marks, std::vector<std::uint32_t>& index,
                      std::vector<double>& squared) const;
  /// The point nearest to x among those whose squared distance is less than `squared`, which becomes that of this point; `none` if there is
  /// no such point. The less `squared`, the faster. O(log N).
  [[nodiscard]] std::uint32_t nearest(const Vec3& x, double& squared, std::uint32_t none) const;
  /// Whether a point is closer to x than `distance`, which is 0 or more. O(log N).
  [[nodiscard]] bool any_within(const Vec3& x, double distance) const;
  /// All points closer to x than `radius`, in no particular order; where there are more than `most`, more than `most` of them. O(log N +
  /// points found).
  void within(const Vec3& x, double radius, std::vector<std::uint32_t>& index, std::size_t most = SIZE_MAX) const;
  /// For every point, the min(k, N) points nearest to it, nearest first (itself, but for points in the same place): N x min(k, N),
  /// row-major. O(k N log N). On the device of the call, if it has one, with the same result.
  [[nodiscard]] std::vector<std::uint32_t> of_all(std::size_t k) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace g3r
