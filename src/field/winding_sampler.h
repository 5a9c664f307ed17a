// The winding field of oriented points, as the mesher asks for it.
#pragma once

#include <atomic>
#include <vector>

#include "field/oriented_cloud.h"
#include "mesh/field_sampler.h"
#include "sum/fast_sum.h"

namespace g3r {

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
