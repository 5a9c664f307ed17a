// Points that were taken for outliers, but that the surface of the others goes through.
#pragma once

#include <g3r/points.h>

#include <atomic>
#include <vector>

namespace g3r::mesh {

/// For each stray the normal of the surface there if it goes through it, else 0: where density varies, sparse points of a surface look like
/// outliers as long as nobody knows the surface. It does if the fit (LocalFit) to the points within 1.4 of their spacings passes it at no
/// more than 0.3 of their spacing and a standard deviation of their noise, and so do more of the 32 or 64 points and strays around it than
/// chance puts there if they fill space (kFalseAlarms). Those that are found are points for the others, until there are no more. `normals`:
/// unit, outward. O(N log N) a round, of which there are a few. Throws Cancelled.
[[nodiscard]] std::vector<Vec3> normals_of_regained(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                                                    const std::vector<Vec3>& strays, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
