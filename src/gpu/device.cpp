#include "gpu/device.h"

#include "base/platform.h"
#include "cpu/parallel.h"
#include "cpu/parallel_apart.h"
#include "gpu/cuda.h"
#include "gpu/opencl.h"

#include <algorithm>
#include <atomic>
#include <chrono>

namespace g3r::gpu {
namespace {

constexpr std::size_t kStagingBytes = 8u << 20;  // of two: large beside what starting a copy costs, small beside any other memory
constexpr std::size_t kCopyBlock = 1u << 18;     // bytes that a thread copies at a time
constexpr std::size_t kKeptDevices = 4;          // of calls at once; the devices of more are closed after each

struct Kept {
  std::uint64_t process;
  std::shared_ptr<Device> device;
};

// Slots instead of a lock: in the child of a fork nobody would unlock it. Never destroyed: drivers may be gone by then.
std::array<std::atomic<Kept*>, kKeptDevices>& kept_devices() {
  static auto* const slots = new std::array<std::atomic<Kept*>, kKeptDevices>{};
  return *slots;
}

}  // namespace

void Device::alone(parallel::FunctionRef<> work) {
  parallel::apart([&] {
    const std::unique_lock lock(mutex_);
    work();
  });
}

std::unique_ptr<Buffer> Device::allocate(std::size_t bytes) {
  const std::size_t held = held_->now;
  if (info_.memory > 0 && (held > info_.memory || bytes > info_.memory - held)) {
    throw OutOfMemory("cannot allocate on the device: out of memory, " + std::to_string(bytes >> 20) + " MB more than the " +
                      std::to_string(held >> 20) + " MB in use of " + std::to_string(info_.memory >> 20) + " MB");
  }
  std::unique_ptr<Buffer> buffer = make_buffer(bytes);
  buffer->held_ = held_;
  held_->now += bytes;
  held_->most = std::max(held_->most.load(), held_->now.load());
  return buffer;
}

Staging& Device::staging(std::size_t k) {
  std::unique_ptr<Staging>& made = staging_[k];
  if (!made) made = make_staging(kStagingBytes);
  made->wait();
  return *made;
}

void Device::write(const Buffer& to, std::size_t offset, const void* from, std::size_t bytes) {
  const auto* const source = static_cast<const unsigned char*>(from);
  for (std::size_t done = 0, k = 0; done < bytes; k = 1 - k) {
    const std::size_t part = std::min(kStagingBytes, bytes - done);
    Staging& through = staging(k);
    parallel::for_blocks(part, kCopyBlock, [&](std::size_t begin, std::size_t end) {
      std::memcpy(through.data() + begin, source + done + begin, end - begin);
    });
    start_write(to, offset + done, through, part);
    done += part;
  }
}

void Device::read(const Buffer& from, std::size_t bytes, std::size_t unit,
                  const std::function<void(std::size_t offset, const unsigned char* data, std::size_t bytes)>& use) {
  const std::size_t most = kStagingBytes / unit * unit;
  const auto part = [&](std::size_t offset) { return std::min(most, bytes - offset); };
  if (bytes > 0) start_read(from, 0, staging(0), part(0));
  for (std::size_t done = 0, k = 0; done < bytes; k = 1 - k) {
    const std::size_t some = part(done);
    const std::size_t next = done + some;
    if (next < bytes) start_read(from, next, staging(1 - k), part(next));
    use(done, staging(k).data(), some);
    done = next;
  }
}

Program& Device::program(const std::string& source) {
  std::unique_ptr<Program>& made = programs_[source];
  if (!made) made = compile(source);
  return *made;
}

void Device::launch(Kernel& kernel, std::size_t groups, std::size_t group_size, const std::vector<Argument>& arguments,
                    std::size_t shared_bytes) {
  if (groups == 0) return;
  if (!timed_) return start(kernel, groups, group_size, arguments, shared_bytes);
  finish();
  const auto begin = std::chrono::steady_clock::now();
  start(kernel, groups, group_size, arguments, shared_bytes);
  finish();
  seconds_[kernel.name()] += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::map<std::string, double> Device::take_kernel_seconds() {
  timed_ = false;
  return std::exchange(seconds_, {});
}

std::vector<DeviceInfo> list_devices(Software software) {
  std::vector<DeviceInfo> all = cuda_devices();
  const std::size_t of_cuda = all.size();
  for (const DeviceInfo& info : opencl_devices(software)) {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(of_cuda);
    const bool known = std::any_of(all.begin(), end, [&](const DeviceInfo& d) { return d.name == info.name; });
    if (!known || info.software) all.push_back(info);
  }
  std::stable_partition(all.begin(), all.end(), [](const DeviceInfo& d) { return !d.software; });
  return all;
}

std::shared_ptr<Device> open_device(const DeviceInfo& info) { return info.cuda ? open_cuda(info) : open_opencl(info); }

void keep_device(std::shared_ptr<Device> device) {
  auto entry = std::make_unique<Kept>(Kept{platform::process(), std::move(device)});
  for (std::atomic<Kept*>& slot : kept_devices()) {
    Kept* empty = nullptr;
    if (slot.compare_exchange_strong(empty, entry.get())) {
      (void)entry.release();
      return;
    }
  }
}

std::shared_ptr<Device> take_kept_device(const DeviceInfo& info) {
  for (std::atomic<Kept*>& slot : kept_devices()) {
    Kept* const entry = slot.exchange(nullptr);
    if (entry == nullptr) continue;
    if (entry->process != platform::process()) continue;  // its driver does not work here, not even to free it
    std::shared_ptr<Device> device = std::move(entry->device);
    delete entry;
    const DeviceInfo& kept = device->info();
    if (kept.cuda == info.cuda && kept.handle[0] == info.handle[0] && kept.handle[1] == info.handle[1]) return device;
    keep_device(std::move(device));
  }
  return nullptr;
}

}  // namespace g3r::gpu
