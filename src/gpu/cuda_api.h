// The part of CUDA's driver interface that is used, declared here so that no header is needed to build. Source: NVIDIA, CUDA Driver API.
#pragma once

#include "gpu/library.h"

#include <cstddef>
#include <cstdint>

namespace g3r::gpu::cuda {

struct ContextTag;
struct ModuleTag;
struct FunctionTag;
struct EventTag;
using Context = ContextTag*;
using Module = ModuleTag*;
using Function = FunctionTag*;
using Event = EventTag*;
using Pointer = std::uint64_t;

inline constexpr int kSuccess = 0;
inline constexpr int kOutOfMemory = 2;

// CUdevice_attribute
inline constexpr int kSharedMemoryPerBlock = 8;
inline constexpr int kComputeMajor = 75;
inline constexpr int kComputeMinor = 76;

inline constexpr unsigned kEventWithoutTime = 2;  // CU_EVENT_DISABLE_TIMING

/// Functions of libcuda. All are there, or none is used.
struct Api {
  int (*init)(unsigned);
  int (*driver_version)(int*);
  int (*device_count)(int*);
  int (*device)(int*, int);
  int (*device_name)(char*, int, int);
  int (*device_memory)(std::size_t*, int);
  int (*device_attribute)(int*, int, int);
  int (*retain_context)(Context*, int);
  int (*release_context)(int);
  int (*push_context)(Context);
  int (*pop_context)(Context*);
  int (*allocate)(Pointer*, std::size_t);
  int (*free)(Pointer);
  int (*allocate_host)(void**, std::size_t, unsigned);
  int (*free_host)(void*);
  int (*start_to_device)(Pointer, const void*, std::size_t, void*);
  int (*start_from_device)(void*, Pointer, std::size_t, void*);
  int (*create_event)(Event*, unsigned);
  int (*destroy_event)(Event);
  int (*record_event)(Event, void*);
  int (*wait_for_event)(Event);
  int (*load_module)(Module*, const void*);
  int (*unload_module)(Module);
  int (*function)(Function*, Module, const char*);
  int (*launch)(Function, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, void*, void**, void**);
  int (*synchronize)();
  int (*error_text)(int, const char**);

  bool load(const char* name) {
    const Library library({name});
    return library.find("cuInit", init) && library.find("cuDriverGetVersion", driver_version) &&
           library.find("cuDeviceGetCount", device_count) && library.find("cuDeviceGet", device) &&
           library.find("cuDeviceGetName", device_name) && library.find("cuDeviceTotalMem_v2", device_memory) &&
           library.find("cuDeviceGetAttribute", device_attribute) && library.find("cuDevicePrimaryCtxRetain", retain_context) &&
           library.find("cuDevicePrimaryCtxRelease_v2", release_context) && library.find("cuCtxPushCurrent_v2", push_context) &&
           library.find("cuCtxPopCurrent_v2", pop_context) && library.find("cuMemAlloc_v2", allocate) &&
           library.find("cuMemFree_v2", free) && library.find("cuMemHostAlloc", allocate_host) &&
           library.find("cuMemFreeHost", free_host) && library.find("cuMemcpyHtoDAsync_v2", start_to_device) &&
           library.find("cuMemcpyDtoHAsync_v2", start_from_device) && library.find("cuEventCreate", create_event) &&
           library.find("cuEventDestroy_v2", destroy_event) && library.find("cuEventRecord", record_event) &&
           library.find("cuEventSynchronize", wait_for_event) && library.find("cuModuleLoadData", load_module) &&
           library.find("cuModuleUnload", unload_module) && library.find("cuModuleGetFunction", function) &&
           library.find("cuLaunchKernel", launch) && library.find("cuCtxSynchronize", synchronize) &&
           library.find("cuGetErrorString", error_text);
  }
};

}  // namespace g3r::gpu::cuda
