// CUDA's compiler, NVRTC, found at run time: kernels to PTX. Needs neither a toolkit nor a GPU. Internal to src/gpu.
#pragma once

#include <string>
#include <vector>

namespace g3r::gpu {

/// Whether the library was found: libnvrtc where the loader looks, or in /usr/local/cuda.
[[nodiscard]] bool nvrtc_available();
/// "12.4"; empty without it.
[[nodiscard]] std::string nvrtc_version();
/// Architectures it compiles for, ascending: 70 for sm_70. Empty without it.
[[nodiscard]] std::vector<int> nvrtc_architectures();
/// PTX of a source of gpu/kernel_source.h for an architecture. Throws DeviceError with the first line that complains.
[[nodiscard]] std::string compile_ptx(const std::string& source, int architecture);

}  // namespace g3r::gpu
