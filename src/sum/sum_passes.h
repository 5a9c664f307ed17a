// The passes of a sum on the processor: points to multipoles, up, across, down, locals to points, and the near field.
// gpu/sum_on_device.h is the same on a device. Sources: Greengard and Rokhlin 1997 for the passes; Dehnen 2002 for the traversal.
// Internal to src/sum.
#pragma once

#include "cpu/aligned_vector.h"
#include "cpu/near_field.h"
#include "cpu/sum_request.h"
#include "expansions/m2l_matrices.h"
#include "sum/sum_geometry.h"

#include <cstdint>
#include <functional>
#include <optional>

namespace g3r {

/// What becomes of the sums at the targets [first, first + count): their blocks of cpu::kLanes x out_channels, channels of a target
/// cpu::kLanes apart. Called from many threads, once for every target.
using TakeSums = std::function<void(std::uint32_t first, std::uint32_t count, const double* sums)>;

/// Passes over one set of sources, whose multipoles are kept while the values are the same.
template <class T>
class SumPasses {
 public:
  /// The values of the sources are to change.
  void forget_multipoles() { multipoles_of_.reset(); }
  /// Sums are without 1/(4 pi); what is held for targets is made part by part of their tree. Throws Cancelled.
  void run(SumGeometry<T>& geometry, const cpu::SumRequest<T>& request, const M2lTerms& terms, const TakeSums& take);

 private:
  class Run;
  UnsetVector<T> multipoles_;                   // passes write all of them
  std::optional<cpu::NearForm> multipoles_of_;  // the form for which they are those of the values
};

extern template class SumPasses<float>;
extern template class SumPasses<double>;

}  // namespace g3r
