#include "gpu/neighbours_on_device.h"

#include "cpu/parallel.h"
#include "gpu/kernel_source.h"
#include "gpu/lists_on_device.h"

#include <algorithm>
#include <cstring>

namespace g3r::gpu {
namespace {

constexpr std::size_t kTakenBytes = 1u << 18;  // bytes that a thread copies at a time

}  // namespace

std::vector<std::uint32_t> nearest_of_all(Device& device, const SearchTree& tree, std::size_t k) {
  const std::size_t count = tree.order.size();
  const bool software = device.info().software;
  Kernel& kernel = device.program(neighbours_source(k, tree.leaf, software)).kernel("nearest_of_all");
  const std::size_t group = neighbours_group(software);
  const std::unique_ptr<Buffer> points = upload(device, tree.points);
  const std::unique_ptr<Buffer> order = upload(device, tree.order);
  const std::unique_ptr<Buffer> cuts = upload(device, tree.cuts);
  const std::unique_ptr<Buffer> there = device.allocate(count * k * sizeof(std::uint32_t));
  const std::size_t leaves = (count + tree.leaf - 1) / tree.leaf;
  device.launch(kernel, (count + group - 1) / group, group, {narrow(count), narrow(leaves), *points, *order, *cuts, *there}, 0);
  std::vector<std::uint32_t> out(count * k);
  auto* const bytes = reinterpret_cast<unsigned char*>(out.data());
  device.finish();
  device.read(*there, there->bytes(), sizeof(std::uint32_t), [&](std::size_t offset, const unsigned char* data, std::size_t some) {
    parallel::for_blocks(some, kTakenBytes,
                         [&](std::size_t begin, std::size_t end) { std::memcpy(bytes + offset + begin, data + begin, end - begin); });
  });
  return out;
}

}  // namespace g3r::gpu
