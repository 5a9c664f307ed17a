// Source: NVIDIA, NVRTC User Guide. Its declarations are here so that no header is needed to build.
#include "gpu/nvrtc.h"

#include "gpu/device.h"
#include "gpu/kernel_cache.h"
#include "gpu/library.h"

#include <array>
#include <memory>

namespace g3r::gpu {
namespace {

struct NvrtcProgram;

struct Api {
  int (*version)(int*, int*);
  int (*number_of_architectures)(int*);
  int (*architectures)(int*);
  int (*create)(NvrtcProgram**, const char*, const char*, int, const char* const*, const char* const*);
  int (*destroy)(NvrtcProgram**);
  int (*compile)(NvrtcProgram*, int, const char* const*);
  int (*ptx_size)(NvrtcProgram*, std::size_t*);
  int (*ptx)(NvrtcProgram*, char*);
  int (*log_size)(NvrtcProgram*, std::size_t*);
  int (*log)(NvrtcProgram*, char*);

  bool load() {
    const Library library({"libnvrtc.so", "libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so.11.2", "/usr/local/cuda/lib64/libnvrtc.so",
                           "/usr/local/cuda/lib/libnvrtc.so", "nvrtc64_130_0.dll", "nvrtc64_120_0.dll", "nvrtc64_112_0.dll"});
    return library.find("nvrtcVersion", version) && library.find("nvrtcGetNumSupportedArchs", number_of_architectures) &&
           library.find("nvrtcGetSupportedArchs", architectures) && library.find("nvrtcCreateProgram", create) &&
           library.find("nvrtcDestroyProgram", destroy) && library.find("nvrtcCompileProgram", compile) &&
           library.find("nvrtcGetPTXSize", ptx_size) && library.find("nvrtcGetPTX", ptx) &&
           library.find("nvrtcGetProgramLogSize", log_size) && library.find("nvrtcGetProgramLog", log);
  }
};

const Api* api() {
  static const std::unique_ptr<Api> loaded = [] {
    auto functions = std::make_unique<Api>();
    return functions->load() ? std::move(functions) : nullptr;
  }();
  return loaded.get();
}

void check(int code) {
  if (code != 0) throw DeviceError("cannot compile for the device: NVRTC error " + std::to_string(code));
}

}  // namespace

bool nvrtc_available() { return api() != nullptr; }

std::string nvrtc_version() {
  int major = 0;
  int minor = 0;
  if (api() == nullptr || api()->version(&major, &minor) != 0) return {};
  return std::to_string(major) + '.' + std::to_string(minor);
}

std::vector<int> nvrtc_architectures() {
  int count = 0;
  if (api() == nullptr || api()->number_of_architectures(&count) != 0 || count <= 0) return {};
  std::vector<int> out(static_cast<std::size_t>(count));
  if (api()->architectures(out.data()) != 0) return {};
  return out;
}

std::string compile_ptx(const std::string& source, int architecture) {
  if (api() == nullptr) throw DeviceError("cannot compile for the device: there is no NVRTC");
  NvrtcProgram* made = nullptr;
  check(api()->create(&made, source.c_str(), "g3r.cu", 0, nullptr, nullptr));
  const auto destroy = [](NvrtcProgram* p) { api()->destroy(&p); };
  const std::unique_ptr<NvrtcProgram, decltype(destroy)> program(made, destroy);
  const std::string target = "--gpu-architecture=compute_" + std::to_string(architecture);
  const std::array<const char*, 3> options{target.c_str(), "--std=c++17", "--disable-warnings"};
  const int code = api()->compile(made, static_cast<int>(options.size()), options.data());
  std::size_t size = 0;
  if (code != 0) {
    std::string log;
    if (api()->log_size(made, &size) == 0 && size > 0) {
      log.resize(size);
      api()->log(made, log.data());
    }
    throw DeviceError("cannot compile for the device: " + first_complaint(log, "NVRTC error " + std::to_string(code)));
  }
  check(api()->ptx_size(made, &size));
  std::string ptx(size, '\0');
  check(api()->ptx(made, ptx.data()));
  return ptx;
}

}  // namespace g3r::gpu
