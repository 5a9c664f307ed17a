// Coordinates as whole numbers of steps, as LAS and EPT store them, and the decimals that such numbers were written with.
#pragma once

#include <g3r/points.h>

#include <optional>

namespace g3r::io {

/// Coordinates on an axis: a whole number of steps stands for steps * scale + offset. Where the scale is a power of ten and the offset a
/// whole number of steps, as almost always, the value is the double nearest to that decimal number: 86064 steps of 0.001 are 86.064, as a
/// text that says so is read, not 86.06400000000001.
class DecimalSteps {
 public:
  explicit DecimalSteps(double scale = 1, double offset = 0);
  [[nodiscard]] double value(double steps) const { return power_ > 0 ? (steps + shift_) / power_ : steps * scale_ + offset_; }
  /// The whole number of steps that is nearest to a value.
  [[nodiscard]] double steps(double value) const;
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double offset() const { return offset_; }

 private:
  double scale_;
  double offset_;
  double power_ = 0;  // 1 / scale where that is a power of ten, else 0
  double shift_ = 0;  // the offset in steps
};

/// Steps of so many decimals for numbers from `low` to `high`, if their count fits in 32 bits. The offset is 0 where it may be, else a
/// multiple of a million steps.
std::optional<DecimalSteps> exact_steps(double low, double high, int decimals);

/// Steps of a power of ten, so small that the extent takes about 30 bits.
DecimalSteps fine_steps(double low, double high);

/// The fewest decimals that give some numbers back.
class Decimals {
 public:
  /// `precision`: of the numbers as they were read; what of them a float does not hold does not count for Scalar::kFloat32.
  explicit Decimals(Scalar precision) : precision_(precision) {}
  void add(double value);
  /// How many all numbers so far need, none where they need more than kMost.
  [[nodiscard]] std::optional<int> count() const { return count_ <= kMost ? std::optional(count_) : std::nullopt; }

  static constexpr int kMost = 15;  ///< more are not exact in a double

 private:
  Scalar precision_;
  int count_ = 0;
};

/// 10^exponent, for exponents from 0 to 22 exactly.
double power_of_ten(int exponent);

}  // namespace g3r::io
