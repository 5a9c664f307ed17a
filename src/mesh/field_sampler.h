// The seam between the mesher and whatever evaluates the winding field.
#pragma once

#include <g3r/points.h>

#include <vector>

namespace g3r {

/// A scalar field in space, larger inside than outside; for the winding field w about 1 inside and 0 outside.
/// sample() must be a pure function of each query: the same value whatever else is in the batch and whatever the number of threads.
struct FieldSampler {
  FieldSampler() = default;
  FieldSampler(const FieldSampler&) = default;
  FieldSampler& operator=(const FieldSampler&) = default;
  virtual ~FieldSampler() = default;
  /// Q queries -> Q values and, unless `gradient` is null, Q gradients. Both vectors are resized.
  virtual void sample(const std::vector<Vec3>& queries, std::vector<double>& value, std::vector<Vec3>* gradient) const = 0;
};

}  // namespace g3r
