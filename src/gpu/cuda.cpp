// Source: NVIDIA, CUDA Driver API.
#include "gpu/cuda.h"

#include "gpu/cuda_api.h"
#include "gpu/kernel_cache.h"
#include "gpu/nvrtc.h"

#include <algorithm>
#include <array>
#include <limits>

namespace g3r::gpu {
namespace {

using namespace cuda;  // NOLINT(google-build-using-namespace): its names are those of the interface alone

const Api* api() {
  static const std::unique_ptr<Api> loaded = [] {
    auto functions = std::make_unique<Api>();
    const bool found = functions->load("libcuda.so.1") || functions->load("nvcuda.dll");
    const bool usable = found && functions->init(0) == kSuccess;
    return usable ? std::move(functions) : nullptr;
  }();
  return loaded.get();
}

void check(int code, const char* what) {
  if (code == kSuccess) return;
  std::string why = "CUDA error " + std::to_string(code);
  const char* text = nullptr;
  if (code == kOutOfMemory) throw OutOfMemory(std::string(what) + ": out of memory");
  if (api()->error_text(code, &text) == kSuccess && text != nullptr) {
    why = text;
  }
  throw DeviceError(std::string(what) + ": " + why);
}

// The device's context for as long as this lives; whatever the caller's thread works with comes back after it.
class Current {
 public:
  explicit Current(Context context) { check(api()->push_context(context), "cannot use the device"); }
  ~Current() {
    Context popped = nullptr;
    api()->pop_context(&popped);
  }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;
};

// For destructors, where a context that is gone has freed everything.
template <class Work>
void in_context(Context context, const Work& work) {
  if (api()->push_context(context) != kSuccess) return;
  work();
  Context popped = nullptr;
  api()->pop_context(&popped);
}

struct CudaBuffer : Buffer {
  Context context;
  Pointer pointer;
  CudaBuffer(std::size_t bytes, Context c, Pointer p) : Buffer(bytes), context(c), pointer(p) {}
  ~CudaBuffer() override {
    in_context(context, [&] { api()->free(pointer); });
  }
  CudaBuffer(const CudaBuffer&) = delete;
  CudaBuffer& operator=(const CudaBuffer&) = delete;
};

// Memory that is locked in its place, so that the device copies at full speed.
class CudaStaging : public Staging {
 public:
  CudaStaging(Context context, std::size_t bytes) : context_(context) {
    const Current current(context_);
    check(api()->create_event(&copied_, kEventWithoutTime), "cannot use the device");
    void* memory = nullptr;
    const int code = api()->allocate_host(&memory, bytes, 0);
    if (code != kSuccess) api()->destroy_event(copied_);
    check(code, "cannot lock memory for copies to the device");
    data_ = static_cast<unsigned char*>(memory);
  }
  ~CudaStaging() override {
    in_context(context_, [&] {
      api()->free_host(data_);
      api()->destroy_event(copied_);
    });
  }
  CudaStaging(const CudaStaging&) = delete;
  CudaStaging& operator=(const CudaStaging&) = delete;

  void wait() override {
    const Current current(context_);
    check(api()->wait_for_event(copied_), "the device failed");
  }
  // Within the context, after a copy was started.
  void started() { check(api()->record_event(copied_, nullptr), "the device failed"); }

 private:
  Context context_;
  Event copied_ = nullptr;
};

struct CudaKernel : Kernel {
  Function function = nullptr;
  using Kernel::Kernel;
};

struct CudaProgram : Program {
  Context context;
  Module module = nullptr;
  std::map<std::string, CudaKernel> kernels;

  CudaProgram(Context c, const std::string& ptx) : context(c) {
    const Current current(context);
    check(api()->load_module(&module, ptx.c_str()), "cannot compile for the device");
  }
  ~CudaProgram() override {
    in_context(context, [&] { api()->unload_module(module); });
  }
  CudaProgram(const CudaProgram&) = delete;
  CudaProgram& operator=(const CudaProgram&) = delete;

  Kernel& kernel(const std::string& name) override {
    const auto found = kernels.find(name);
    if (found != kernels.end()) return found->second;
    const Current current(context);
    CudaKernel made(name);
    check(api()->function(&made.function, module, name.c_str()), "cannot use a kernel");
    return kernels.emplace(name, made).first->second;
  }
};

class CudaDevice : public Device {
 public:
  explicit CudaDevice(const DeviceInfo& info) : Device(info), ordinal_(static_cast<int>(info.handle[0])) {
    check(api()->retain_context(&context_, ordinal_), "cannot use the device");
  }
  ~CudaDevice() override {
    forget();
    api()->release_context(ordinal_);
  }
  CudaDevice(const CudaDevice&) = delete;
  CudaDevice& operator=(const CudaDevice&) = delete;

  void finish() override {
    const Current current(context_);
    check(api()->synchronize(), "the device failed");
  }

 protected:
  std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override {
    const Current current(context_);
    Pointer pointer = 0;
    check(api()->allocate(&pointer, std::max<std::size_t>(bytes, 1)), "cannot allocate on the device");
    return std::make_unique<CudaBuffer>(bytes, context_, pointer);
  }
  std::unique_ptr<Staging> make_staging(std::size_t bytes) override { return std::make_unique<CudaStaging>(context_, bytes); }
  void start_write(const Buffer& to, std::size_t offset, Staging& staging, std::size_t bytes) override {
    const Current current(context_);
    check(api()->start_to_device(pointer(to) + offset, staging.data(), bytes, nullptr), "cannot copy to the device");
    static_cast<CudaStaging&>(staging).started();
  }
  void start_read(const Buffer& from, std::size_t offset, Staging& staging, std::size_t bytes) override {
    const Current current(context_);
    check(api()->start_from_device(staging.data(), pointer(from) + offset, bytes, nullptr), "cannot copy from the device");
    static_cast<CudaStaging&>(staging).started();
  }
  void start(Kernel& kernel, std::size_t groups, std::size_t group_size, const std::vector<Argument>& arguments,
             std::size_t shared_bytes) override {
    if (groups > std::numeric_limits<std::int32_t>::max()) throw DeviceError("too many points for the device");
    std::vector<Pointer> pointers(arguments.size());
    std::vector<void*> places;
    for (std::size_t k = 0; k < arguments.size(); ++k) {
      const Argument& a = arguments[k];
      if (a.buffer != nullptr) pointers[k] = pointer(*a.buffer);
      places.push_back(a.buffer != nullptr ? static_cast<void*>(&pointers[k]) : const_cast<unsigned char*>(a.value));
    }
    const Current current(context_);
    check(api()->launch(static_cast<CudaKernel&>(kernel).function, static_cast<unsigned>(groups), 1, 1, static_cast<unsigned>(group_size),
                        1, 1, static_cast<unsigned>(shared_bytes), nullptr, places.data(), nullptr),
          "cannot run a kernel");
  }
  std::unique_ptr<Program> compile(const std::string& source) override {
    const int architecture = static_cast<int>(info().handle[1]);
    const KernelCache cache("sm_" + std::to_string(architecture) + '\n' + info().driver + '\n' + source);
    const std::vector<unsigned char> kept = cache.read();
    if (!kept.empty()) return std::make_unique<CudaProgram>(context_, std::string(kept.begin(), kept.end()));
    const std::string ptx = compile_ptx(source, architecture);
    auto program = std::make_unique<CudaProgram>(context_, ptx);
    cache.write({ptx.begin(), ptx.end()});
    return program;
  }

 private:
  static Pointer pointer(const Buffer& buffer) { return static_cast<const CudaBuffer&>(buffer).pointer; }

  int ordinal_;
  Context context_ = nullptr;
};

// The architecture to compile for: the latest that both the device and the compiler know; 0 if there is none.
int architecture_for(int capability) {
  int best = 0;
  for (const int known : nvrtc_architectures()) best = known <= capability ? std::max(best, known) : best;
  return best;
}

std::string version_text(int version) { return std::to_string(version / 1000) + '.' + std::to_string(version % 1000 / 10); }

}  // namespace

std::vector<DeviceInfo> cuda_devices() {
  int count = 0;
  // The compiler last: it takes 30 MB, in vain where there is no device.
  if (api() == nullptr || api()->device_count(&count) != kSuccess || count == 0 || !nvrtc_available()) return {};
  int driver = 0;
  api()->driver_version(&driver);
  std::vector<DeviceInfo> out;
  for (int i = 0; i < count; ++i) {
    int ordinal = 0;
    int major = 0;
    int minor = 0;
    int shared = 0;
    std::array<char, 256> name{};
    DeviceInfo info;
    const bool known =
        api()->device(&ordinal, i) == kSuccess && api()->device_name(name.data(), static_cast<int>(name.size()) - 1, ordinal) == kSuccess &&
        api()->device_memory(&info.memory, ordinal) == kSuccess && api()->device_attribute(&major, kComputeMajor, ordinal) == kSuccess &&
        api()->device_attribute(&minor, kComputeMinor, ordinal) == kSuccess &&
        api()->device_attribute(&shared, kSharedMemoryPerBlock, ordinal) == kSuccess;
    const int architecture = architecture_for(10 * major + minor);
    if (!known || architecture == 0) continue;
    info.name = name.data();
    info.driver = "CUDA " + version_text(driver) + ", NVRTC " + nvrtc_version();
    info.doubles = true;
    info.largest_buffer = info.memory;
    info.local_memory = static_cast<std::size_t>(shared);
    info.cuda = true;
    info.handle[0] = static_cast<std::uint64_t>(ordinal);
    info.handle[1] = static_cast<std::uint64_t>(architecture);
    out.push_back(info);
  }
  return out;
}

std::shared_ptr<Device> open_cuda(const DeviceInfo& info) { return std::make_shared<CudaDevice>(info); }

}  // namespace g3r::gpu
