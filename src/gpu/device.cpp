#include "gpu/device.h"

#include "gpu/opencl.h"

#include <algorithm>

namespace g3r::gpu {

Program& Device::program(const std::string& source) {
  std::unique_ptr<Program>& made = programs_[source];
  if (!made) made = compile(source);
  return *made;
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> all = opencl_devices();
  std::stable_partition(all.begin(), all.end(), [](const DeviceInfo& d) { return !d.software; });
  return all;
}

std::shared_ptr<Device> open_device(const DeviceInfo& info) { return open_opencl(info); }

}  // namespace g3r::gpu
