// Source: Khronos, The OpenCL Specification 1.2.
#include "gpu/opencl.h"

#include "gpu/drivers.h"
#include "gpu/kernel_cache.h"
#include "gpu/opencl_api.h"

#include <algorithm>
#include <bit>
#include <map>
#include <utility>

namespace g3r::gpu {
namespace {

using namespace cl;  // NOLINT(google-build-using-namespace): its names are those of the interface alone

constexpr std::size_t kMostLanes = 16;                // of the kernels' vectors: a block of targets
constexpr const char* kOptions = "-cl-std=CL1.2 -w";  // no relaxed arithmetic: kernels rely on exact sums of two

const Api* api() {
  static const std::unique_ptr<Api> loaded = [] {
    auto functions = std::make_unique<Api>();
    return functions->load() ? std::move(functions) : nullptr;
  }();
  return loaded.get();
}

// Of buffers, which drivers may make when they are first used, or larger than the device takes.
bool is_out_of_memory(std::int32_t code) { return code == -4 || code == -5 || code == -6 || code == -61; }

std::string error_name(std::int32_t code) {
  if (is_out_of_memory(code)) return "out of memory";
  switch (code) {
    case -2:
      return "the device is not available";
    case -11:
      return "the kernels do not compile";
    case -36:
      return "the device was lost";
    default:
      return "OpenCL error " + std::to_string(code);
  }
}

void check(std::int32_t code, const char* what) {
  if (code == kSuccess) return;
  const std::string text = std::string(what) + ": " + error_name(code);
  if (is_out_of_memory(code)) throw OutOfMemory(text);
  throw DeviceError(text);
}

template <class T, class Object, class Function>
T number(Function get, Object object, std::uint32_t what) {
  T value{};
  get(object, what, sizeof value, &value, nullptr);
  return value;
}

template <class Object, class Function>
std::string text(Function get, Object object, std::uint32_t what) {
  std::size_t bytes = 0;
  if (get(object, what, 0, nullptr, &bytes) != kSuccess || bytes == 0) return {};
  std::string out(bytes, '\0');
  if (get(object, what, bytes, out.data(), nullptr) != kSuccess) return {};
  out.resize(out.find('\0') == std::string::npos ? out.size() : out.find('\0'));
  return out;
}

std::size_t lanes(std::uint32_t native) { return std::bit_floor(std::clamp<std::size_t>(native, 1, kMostLanes)); }

DeviceInfo describe(Platform platform, DeviceId device) {
  const Api& cl = *api();
  DeviceInfo info;
  info.name = text(cl.get_device_info, device, kDeviceName);
  info.driver = text(cl.get_platform_info, platform, kPlatformVersion) + ", driver " + text(cl.get_device_info, device, kDriverVersion);
  info.software = (number<std::uint64_t>(cl.get_device_info, device, kDeviceType) & kDeviceTypeCpu) != 0;
  info.doubles = text(cl.get_device_info, device, kDeviceExtensions).find("cl_khr_fp64") != std::string::npos;
  info.memory = number<std::uint64_t>(cl.get_device_info, device, kDeviceGlobalMemSize);
  info.largest_buffer = number<std::uint64_t>(cl.get_device_info, device, kDeviceMaxMemAllocSize);
  info.local_memory = number<std::uint64_t>(cl.get_device_info, device, kDeviceLocalMemSize);
  if (info.software) {
    info.lanes_float = lanes(number<std::uint32_t>(cl.get_device_info, device, kDeviceNativeVectorWidthFloat));
    info.lanes_double = lanes(number<std::uint32_t>(cl.get_device_info, device, kDeviceNativeVectorWidthDouble));
  }
  info.handle[0] = reinterpret_cast<std::uintptr_t>(platform);
  info.handle[1] = reinterpret_cast<std::uintptr_t>(device);
  return info;
}

struct ClBuffer : Buffer {
  Memory memory;
  ClBuffer(std::size_t bytes, Memory m) : Buffer(bytes), memory(m) {}
  ~ClBuffer() override { api()->release_mem_object(memory); }
  ClBuffer(const ClBuffer&) = delete;
  ClBuffer& operator=(const ClBuffer&) = delete;
};

// Memory that the driver has made for copies, mapped for good.
class ClStaging : public Staging {
 public:
  ClStaging(Queue queue, Memory memory, unsigned char* mapped) : queue_(queue), memory_(memory) { data_ = mapped; }
  ~ClStaging() override {
    if (copied_ != nullptr) api()->release_event(copied_);
    api()->enqueue_unmap(queue_, memory_, data_, 0, nullptr, nullptr);
    api()->finish(queue_);
    api()->release_mem_object(memory_);
  }
  ClStaging(const ClStaging&) = delete;
  ClStaging& operator=(const ClStaging&) = delete;

  void wait() override {
    if (copied_ == nullptr) return;
    const std::int32_t code = api()->wait_for_events(1, &copied_);
    api()->release_event(std::exchange(copied_, nullptr));
    check(code, "the device failed");
  }
  // For a copy to signal; there is none before.
  Event* copied() { return &copied_; }

 private:
  Queue queue_;
  Memory memory_;
  Event copied_ = nullptr;
};

struct ClKernel : Kernel {
  KernelId id;
  ClKernel(const std::string& name, KernelId k) : Kernel(name), id(k) {}
  ~ClKernel() override { api()->release_kernel(id); }
  ClKernel(const ClKernel&) = delete;
  ClKernel& operator=(const ClKernel&) = delete;
};

struct ClProgram : Program {
  ProgramId id;
  std::map<std::string, ClKernel> kernels;

  explicit ClProgram(ProgramId p) : id(p) {}
  ~ClProgram() override {
    kernels.clear();
    api()->release_program(id);
  }
  ClProgram(const ClProgram&) = delete;
  ClProgram& operator=(const ClProgram&) = delete;

  Kernel& kernel(const std::string& name) override {
    const auto found = kernels.find(name);
    if (found != kernels.end()) return found->second;
    std::int32_t code = 0;
    const KernelId made = api()->create_kernel(id, name.c_str(), &code);
    check(code, "cannot use a kernel");
    return kernels.try_emplace(name, name, made).first->second;
  }
};

class ClDevice : public Device {
 public:
  explicit ClDevice(const DeviceInfo& info) : Device(info), id_(reinterpret_cast<DeviceId>(info.handle[1])) {
    std::int32_t code = 0;
    context_ = api()->create_context(nullptr, 1, &id_, nullptr, nullptr, &code);
    check(code, "cannot use the device");
    queue_ = api()->create_command_queue(context_, id_, 0, &code);
    if (code != kSuccess) api()->release_context(context_);
    check(code, "cannot use the device");
  }
  ~ClDevice() override {
    forget();
    api()->release_command_queue(queue_);
    api()->release_context(context_);
  }
  ClDevice(const ClDevice&) = delete;
  ClDevice& operator=(const ClDevice&) = delete;

  void finish() override { check(api()->finish(queue_), "the device failed"); }

 protected:
  std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override {
    std::int32_t code = 0;
    const Memory memory = api()->create_buffer(context_, kReadWrite, std::max<std::size_t>(bytes, 1), nullptr, &code);
    check(code, "cannot allocate on the device");
    return std::make_unique<ClBuffer>(bytes, memory);
  }
  std::unique_ptr<Staging> make_staging(std::size_t bytes) override {
    std::int32_t code = 0;
    const Memory memory = api()->create_buffer(context_, kReadWrite | kAllocateHostMemory, bytes, nullptr, &code);
    check(code, "cannot allocate for copies to the device");
    void* const mapped = api()->enqueue_map_buffer(queue_, memory, kTrue, kMapReadAndWrite, 0, bytes, 0, nullptr, nullptr, &code);
    if (code != kSuccess) api()->release_mem_object(memory);
    check(code, "cannot allocate for copies to the device");
    return std::make_unique<ClStaging>(queue_, memory, static_cast<unsigned char*>(mapped));
  }
  void start_write(const Buffer& to, std::size_t offset, Staging& staging, std::size_t bytes) override {
    Event* const copied = static_cast<ClStaging&>(staging).copied();
    check(api()->enqueue_write_buffer(queue_, memory(to), kFalse, offset, bytes, staging.data(), 0, nullptr, copied),
          "cannot copy to the device");
  }
  void start_read(const Buffer& from, std::size_t offset, Staging& staging, std::size_t bytes) override {
    Event* const copied = static_cast<ClStaging&>(staging).copied();
    check(api()->enqueue_read_buffer(queue_, memory(from), kFalse, offset, bytes, staging.data(), 0, nullptr, copied),
          "cannot copy from the device");
  }
  void start(Kernel& kernel, std::size_t groups, std::size_t group_size, const std::vector<Argument>& arguments,
             std::size_t shared_bytes) override {
    const KernelId id = static_cast<ClKernel&>(kernel).id;
    std::uint32_t k = 0;
    for (const Argument& a : arguments) {
      const Memory m = a.buffer != nullptr ? memory(*a.buffer) : nullptr;
      check(a.buffer != nullptr ? api()->set_kernel_arg(id, k, sizeof m, &m) : api()->set_kernel_arg(id, k, a.bytes, a.value),
            "cannot pass an argument to a kernel");
      ++k;
    }
    if (shared_bytes > 0) check(api()->set_kernel_arg(id, k, shared_bytes, nullptr), "not enough local memory on the device");
    const std::size_t items = groups * group_size;
    check(api()->enqueue_nd_range_kernel(queue_, id, 1, nullptr, &items, &group_size, 0, nullptr, nullptr), "cannot run a kernel");
  }
  std::unique_ptr<Program> compile(const std::string& source) override {
    // PoCL's own cache keeps what it makes of a source for each launch; binaries of it take twice the time to make.
    const KernelCache cache =
        info().software ? KernelCache() : KernelCache(info().name + '\n' + info().driver + '\n' + kOptions + '\n' + source);
    if (std::unique_ptr<Program> kept = from_binary(cache.read())) return kept;
    const char* start = source.data();
    const std::size_t length = source.size();
    std::int32_t code = 0;
    auto program = std::make_unique<ClProgram>(api()->create_program_with_source(context_, 1, &start, &length, &code));
    check(code, "cannot compile for the device");
    code = api()->build_program(program->id, 1, &id_, kOptions, nullptr, nullptr);
    if (code != kSuccess) throw DeviceError("cannot compile for the device: " + build_log(program->id, code));
    if (!cache.file().empty()) cache.write(binary(program->id));
    return program;
  }

 private:
  static Memory memory(const Buffer& buffer) { return static_cast<const ClBuffer&>(buffer).memory; }

  // One line: the first that names an error.
  std::string build_log(ProgramId program, std::int32_t code) const {
    std::size_t bytes = 0;
    api()->get_program_build_info(program, id_, kProgramBuildLog, 0, nullptr, &bytes);
    std::string log(bytes, '\0');
    api()->get_program_build_info(program, id_, kProgramBuildLog, bytes, log.data(), nullptr);
    return first_complaint(log, error_name(code));
  }

  static std::vector<unsigned char> binary(ProgramId program) {
    std::size_t bytes = 0;
    if (api()->get_program_info(program, kProgramBinarySizes, sizeof bytes, &bytes, nullptr) != kSuccess) return {};
    std::vector<unsigned char> out(bytes);
    unsigned char* data = out.data();
    if (api()->get_program_info(program, kProgramBinaries, sizeof data, static_cast<void*>(&data), nullptr) != kSuccess) return {};
    return out;
  }

  // Null if the driver does not take it.
  [[nodiscard]] std::unique_ptr<Program> from_binary(const std::vector<unsigned char>& bytes) const {
    if (bytes.empty()) return nullptr;
    const unsigned char* data = bytes.data();
    const std::size_t size = bytes.size();
    std::int32_t status = 0;
    std::int32_t code = 0;
    const ProgramId made = api()->create_program_with_binary(context_, 1, &id_, &size, &data, &status, &code);
    if (made == nullptr) return nullptr;
    auto program = std::make_unique<ClProgram>(made);
    if (code != kSuccess || status != kSuccess) return nullptr;
    if (api()->build_program(made, 1, &id_, kOptions, nullptr, nullptr) != kSuccess) return nullptr;
    return program;
  }

  DeviceId id_;
  Context context_ = nullptr;
  Queue queue_ = nullptr;
};

}  // namespace

std::vector<DeviceInfo> opencl_devices(Software software) {
  if (api() == nullptr) return {};
  if (software == Software::kNotLoaded && only_software(listed_drivers(api()->loader))) return {};
  const Api& cl = *api();
  std::uint32_t count = 0;
  if (cl.get_platform_ids(0, nullptr, &count) != kSuccess || count == 0) return {};
  std::vector<Platform> platforms(count);
  if (cl.get_platform_ids(count, platforms.data(), nullptr) != kSuccess) return {};
  std::vector<DeviceInfo> out;
  for (const Platform platform : platforms) {
    if (cl.get_device_ids(platform, kDeviceTypeAll, 0, nullptr, &count) != kSuccess || count == 0) continue;
    std::vector<DeviceId> devices(count);
    if (cl.get_device_ids(platform, kDeviceTypeAll, count, devices.data(), nullptr) != kSuccess) continue;
    for (const DeviceId device : devices) {
      const bool usable = number<std::uint32_t>(cl.get_device_info, device, kDeviceAvailable) != 0 &&
                          number<std::uint32_t>(cl.get_device_info, device, kDeviceCompilerAvailable) != 0;
      if (usable) out.push_back(describe(platform, device));
    }
  }
  return out;
}

std::shared_ptr<Device> open_opencl(const DeviceInfo& info) { return std::make_shared<ClDevice>(info); }

}  // namespace g3r::gpu
