// What no method can do better on noisy points, whatever it knows of the surface.
#pragma once

#include <g3r/mesh.h>

#include <cstdint>
#include <vector>

#include "inputs.h"

namespace g3r::bench {

/// Of every surface point x, the mean normal of where on the true surface it may come from, normalised:
///     integral of n(y) exp(-|x - y|^2 / 2 s^2) dA(y),     s the noise of the input.
/// Samples are even over the surface, so that this is the direction of E[n | x], and no other has a smaller expected AE_p (1 - n . m) / 2:
/// it is Bayes's estimate, which knows the true surface (Berger, "Statistical Decision Theory and Bayesian Analysis", 1985, section 4.4).
/// By 400,000 samples of the surface within 5 s, the nearest where there is none. Throws InvalidInput for an input without noise.
[[nodiscard]] std::vector<Vec3> ceiling_normals(const Mesh& truth, const Input& input, std::uint64_t seed);

}  // namespace g3r::bench
