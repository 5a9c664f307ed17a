// The winding field of oriented points, as the mesher asks for it.
#pragma once

#include <atomic>
#include <vector>

#include "field/oriented_cloud.h"
#include "mesh/field_sampler.h"
#include "sum/fast_sum.h"

namespace g3r {

/// The width of the field of areas and meshes, in spacings: with 0.55 the sword's AE_m is 1.9 instead of 1.5.
inline constexpr double kFieldWidth = 0.35;
/// The accuracy of its sums: signs count from 0.2 beside the level on, and 1e-3 changes CD and AE_m by less than 0.5 %.
inline constexpr double kFieldAccuracy = 1e-2;

/// In normalised units.
class WindingSampler : public FieldSampler {
 public:
  /// `oriented` must outlive this.
  WindingSampler(const OrientedCloud& oriented, const std::atomic<bool>* cancel);
  void sample(const std::vector<Vec3>& queries, std::vector<double>& value, std::vector<Vec3>* gradient) const override;

 private:
  const OrientedCloud& oriented_;
  const std::atomic<bool>* cancel_;
  FastSum sum_;
};

/// Whether the points face into the solid that they surround, as those of a room do that is seen from inside. `field`: of `oriented`.
[[nodiscard]] bool is_inside_out(const OrientedCloud& oriented, const WindingSampler& field);

}  // namespace g3r
