// The steps in which a new LAS file stores its coordinates: all of them have to be known before it begins.
#pragma once

#include "io/decimal_steps.h"

#include <g3r/io.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace g3r::io {

/// Coordinates get as many decimals as they were read with, where their extent in such steps fits in 32 bits, else steps of a power of
/// ten, at most 5e-9 of the extent.
class LasCoordinates {
 public:
  /// `precision`: of the numbers as they were read.
  explicit LasCoordinates(Scalar precision)
      : decimals_{Decimals(precision), Decimals(precision), Decimals(precision)}, precision_(precision) {}
  /// Takes note of a point. Throws InvalidInput for one that is not finite.
  void add(const Vec3& position);
  /// Decides, after the last point. Returns a warning where coordinates are rounded, else "".
  std::string finish();

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  [[nodiscard]] const DecimalSteps& steps(std::size_t axis) const { return steps_[axis]; }

 private:
  std::array<Decimals, 3> decimals_;
  Scalar precision_;
  std::uint64_t count_ = 0;
  Box bounds_{};
  std::array<DecimalSteps, 3> steps_;
};

}  // namespace g3r::io
