#include "gpu/device.h"

#include "gpu/cuda.h"
#include "gpu/opencl.h"

#include <algorithm>

namespace g3r::gpu {

Program& Device::program(const std::string& source) {
  std::unique_ptr<Program>& made = programs_[source];
  if (!made) made = compile(source);
  return *made;
}

std::vector<DeviceInfo> list_devices(Software software) {
  std::vector<DeviceInfo> all = opencl_devices(software);
  const std::size_t of_opencl = all.size();
  for (const DeviceInfo& info : cuda_devices()) {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(of_opencl);
    const bool known = std::any_of(all.begin(), end, [&](const DeviceInfo& d) { return !d.software && d.name == info.name; });
    if (!known) all.push_back(info);
  }
  std::stable_partition(all.begin(), all.end(), [](const DeviceInfo& d) { return !d.software; });
  return all;
}

std::shared_ptr<Device> open_device(const DeviceInfo& info) { return info.cuda ? open_cuda(info) : open_opencl(info); }

}  // namespace g3r::gpu
