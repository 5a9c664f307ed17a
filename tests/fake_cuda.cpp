// A CUDA driver without a GPU, for cuda_driver_test: memory is the host's, and there is one kernel, fill(float* p, float v, int n). Counts
// what is not given back, and fails on demand.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

struct State {
  int buffers = 0;
  int modules = 0;
  int contexts = 0;  ///< retained
  int pushed = 0;
  int events = 0;
  int failure = 0;  ///< code that copies, launches and waiting return
};
State state;
int context_itself = 0;
constexpr std::size_t kMemory = std::size_t{1} << 30;
constexpr int kOutOfMemory = 2;
constexpr int kNotFound = 500;
constexpr int kNoContext = 201;

}  // namespace

extern "C" {

const State* fake_cuda_state() { return &state; }
void fake_cuda_fail(int code) { state.failure = code; }

// NVRTC looks for a table of the driver's; this one is too old to hold anything.
int cuGetExportTable(const void** table, const void*) {
  static const std::size_t bytes = sizeof bytes;
  return *table = &bytes, 0;
}
int cuInit(unsigned) { return 0; }
int cuDriverGetVersion(int* version) { return *version = 12040, 0; }
int cuDeviceGetCount(int* count) { return *count = 1, 0; }
int cuDeviceGet(int* device, int number) { return *device = number, 0; }
int cuDeviceGetName(char* name, int size, int) { return std::strncpy(name, "Fake GPU", static_cast<std::size_t>(size)), 0; }
int cuDeviceTotalMem_v2(std::size_t* bytes, int) { return *bytes = kMemory, 0; }
int cuDeviceGetAttribute(int* value, int attribute, int) { return *value = attribute == 75 ? 9 : attribute == 76 ? 0 : 49152, 0; }
int cuDevicePrimaryCtxRetain(void** context, int) { return ++state.contexts, *context = &context_itself, 0; }
int cuDevicePrimaryCtxRelease_v2(int) { return --state.contexts, 0; }
int cuCtxPushCurrent_v2(void* context) { return context == &context_itself ? (++state.pushed, 0) : kNoContext; }
int cuCtxPopCurrent_v2(void** context) { return --state.pushed, *context = nullptr, 0; }
int cuMemAlloc_v2(std::uint64_t* pointer, std::size_t bytes) {
  if (state.pushed == 0) return kNoContext;
  if (bytes > kMemory) return kOutOfMemory;
  ++state.buffers;
  return *pointer = reinterpret_cast<std::uintptr_t>(std::calloc(bytes, 1)), 0;
}
int cuMemFree_v2(std::uint64_t pointer) {
  if (state.pushed == 0) return kNoContext;
  --state.buffers;
  return std::free(reinterpret_cast<void*>(pointer)), 0;
}
int cuMemHostAlloc(void** memory, std::size_t bytes, unsigned) {
  if (state.pushed == 0) return kNoContext;
  ++state.buffers;
  return *memory = std::calloc(bytes, 1), 0;
}
int cuMemFreeHost(void* memory) {
  if (state.pushed == 0) return kNoContext;
  --state.buffers;
  return std::free(memory), 0;
}
int cuMemcpyHtoDAsync_v2(std::uint64_t to, const void* from, std::size_t bytes, void*) {
  if (state.pushed == 0 || state.failure != 0) return state.pushed == 0 ? kNoContext : state.failure;
  return std::memcpy(reinterpret_cast<void*>(to), from, bytes), 0;
}
int cuMemcpyDtoHAsync_v2(void* to, std::uint64_t from, std::size_t bytes, void*) {
  if (state.pushed == 0 || state.failure != 0) return state.pushed == 0 ? kNoContext : state.failure;
  return std::memcpy(to, reinterpret_cast<const void*>(from), bytes), 0;
}
int cuEventCreate(void** event, unsigned) { return ++state.events, *event = &state.events, 0; }
int cuEventDestroy_v2(void*) { return --state.events, 0; }
int cuEventRecord(void*, void*) { return state.pushed == 0 ? kNoContext : 0; }
int cuEventSynchronize(void*) { return state.failure; }
int cuModuleLoadData(void** module, const void* ptx) {
  if (state.pushed == 0) return kNoContext;
  ++state.modules;
  return *module = new std::string(static_cast<const char*>(ptx)), 0;
}
int cuModuleUnload(void* module) {
  --state.modules;
  return delete static_cast<std::string*>(module), 0;
}
int cuModuleGetFunction(void** function, void* module, const char* name) {
  if (static_cast<std::string*>(module)->find(".entry " + std::string(name)) == std::string::npos) return kNotFound;
  return *function = module, 0;
}
int cuLaunchKernel(void*, unsigned groups, unsigned, unsigned, unsigned items, unsigned, unsigned, unsigned, void*, void** arguments,
                   void**) {
  if (state.pushed == 0 || state.failure != 0) return state.pushed == 0 ? kNoContext : state.failure;
  auto* p = reinterpret_cast<float*>(*static_cast<std::uint64_t*>(arguments[0]));
  const float value = *static_cast<float*>(arguments[1]);
  const int n = *static_cast<int*>(arguments[2]);
  for (unsigned i = 0; i < groups * items && i < static_cast<unsigned>(n); ++i) p[i] = value;
  return 0;
}
int cuCtxSynchronize() { return state.failure; }
int cuGetErrorString(int code, const char** text) {
  return *text = code == 700 ? "an illegal memory access was encountered" : "unknown", 0;
}

}  // extern "C"
