// Devices through OpenCL. Internal to src/gpu.
#pragma once

#include "gpu/device.h"

namespace g3r::gpu {

/// Empty without OpenCL.
[[nodiscard]] std::vector<DeviceInfo> opencl_devices(Software software);
[[nodiscard]] std::shared_ptr<Device> open_opencl(const DeviceInfo& info);

}  // namespace g3r::gpu
