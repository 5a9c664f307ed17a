// Devices through CUDA's driver and NVRTC. Internal to src/gpu.
#pragma once

#include "gpu/device.h"

namespace g3r::gpu {

/// Empty without a driver or without NVRTC.
[[nodiscard]] std::vector<DeviceInfo> cuda_devices();
[[nodiscard]] std::shared_ptr<Device> open_cuda(const DeviceInfo& info);

}  // namespace g3r::gpu
