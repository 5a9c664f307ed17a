// The kernels' text: what a program says before src/gpu/kernels. Internal to src/gpu.
#pragma once

#include "cpu/near_field.h"

#include <cstddef>
#include <string>

namespace g3r::gpu {

/// What the kernels of one form are compiled for.
struct KernelTraits {
  cpu::NearForm form = cpu::NearForm::kWinding;
  int batch = 1;  ///< K of the forms that have one
  bool local_widths = false;
  bool doubles = false;
  bool rough = false;     ///< near field in float: polynomials of kRoughPolynomialError
  std::size_t lanes = 1;  ///< numbers worked on together: DeviceInfo::lanes_float or lanes_double
};

/// Items of a work-group, which a launch of the kernels must use. Processors run the items of a group one after the other.
[[nodiscard]] std::size_t near_group(const KernelTraits& traits);
[[nodiscard]] std::size_t far_group(const KernelTraits& traits);

/// near_field()
[[nodiscard]] std::string near_field_source(const KernelTraits& traits);
/// points_to_multipoles(), locals_to_points()
[[nodiscard]] std::string expansions_source(const KernelTraits& traits);
/// multipoles_to_parents(), multipoles_to_locals(), locals_to_children()
[[nodiscard]] std::string translations_source(const KernelTraits& traits);

/// The vectors of a solve, beside sums in double or float, and the items of a work-group of their kernels.
[[nodiscard]] std::string vectors_source(bool doubles, bool software);
[[nodiscard]] std::size_t vectors_group(bool software);
/// Doubles that a work-group of dot_of_blocks() adds up.
inline constexpr std::size_t kDotBlock = 4096;  // 700 groups of a million points, and little to read back

/// nearest_of_all() of the `k` nearest points in a tree with leaves of `leaf`, and the items of a work-group.
[[nodiscard]] std::string neighbours_source(std::size_t k, std::size_t leaf, bool software);
[[nodiscard]] std::size_t neighbours_group(bool software);

}  // namespace g3r::gpu
