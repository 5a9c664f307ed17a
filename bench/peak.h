// The machine's fused multiply-add rate, to hold kernels against.
#pragma once

#include <cstddef>

namespace g3r::bench {

/// Runs `rounds` rounds of independent fused multiply-adds on vectors of 16 floats (fewer where the machine has narrower ones) and returns
/// their number times 2: floating-point operations. One thread, the instruction set that the kernels use.
double run_multiply_adds(std::size_t rounds);

}  // namespace g3r::bench
