// Gaussian splats as they are drawn along an axis, in parallel rays, and how much light passes between them.
// Source: Kerbl, Kopanas, Leimkuehler, Drettakis, "3D Gaussian Splatting for Real-Time Radiance Field Rendering", 2023.
#pragma once

#include "io/splat_image.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r::io {

/// The splats along one axis: for every tile of the picture those that are drawn in it, from near to far.
class SplatView {
 public:
  /// `drawn`: the indices of those that are, at least one. `ahead`: the axis, a unit vector. Both vectors must outlive this. O(N log N).
  /// Throws Cancelled when `cancel` (may be null) becomes true.
  SplatView(const std::vector<Splat>& splats, const std::vector<std::uint32_t>& drawn, const Vec3& ahead, const std::atomic<bool>* cancel);
  ~SplatView();
  SplatView(const SplatView&) = delete;
  SplatView& operator=(const SplatView&) = delete;

  /// Whether more than half of the light gets to the centre of drawn splat i from one end of the axis, or it cannot be decided.
  [[nodiscard]] bool is_lit(std::uint32_t i) const;
  /// Whether the splats together stop half of the light at the centre of drawn splat i, or it cannot be decided.
  [[nodiscard]] bool is_solid(std::uint32_t i) const;

 private:
  struct Ruler;
  [[nodiscard]] std::size_t tile_of(std::uint32_t i) const;
  template <class Visit>
  void for_tiles(std::uint32_t i, const Visit& visit) const;
  [[nodiscard]] std::size_t entries() const;
  void cut();
  template <class Iterator>
  [[nodiscard]] bool reaches(std::uint32_t i, Iterator begin, Iterator end) const;

  const std::vector<Splat>& splats_;
  const std::vector<std::uint32_t>& drawn_;
  std::vector<SplatImage> images_;
  std::unique_ptr<Ruler> across_, down_;
  std::vector<std::size_t> start_;  // of every tile, and the end
  std::vector<std::uint32_t> list_;
};

}  // namespace g3r::io
