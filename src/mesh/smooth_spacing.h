// The spacing that the mesher goes by.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// The median of h_j = d_8 sqrt(pi / 8) over each point and its 8 neighbours, in input units: less ragged than the spacing of single
/// points, which random sampling scatters, and not led astray by a lone outlier. O(N log N).
[[nodiscard]] std::vector<double> smooth_spacing(const std::vector<Vec3>& positions);
/// The same from Neighbours::of_all(k) of these positions, k >= 9.
[[nodiscard]] std::vector<double> smooth_spacing(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& near);

}  // namespace g3r::mesh
