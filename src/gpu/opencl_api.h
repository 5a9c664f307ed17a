// The part of OpenCL 1.2 that is used, declared here so that no header is needed to build. Names and numbers are those of the standard
// (Khronos, The OpenCL Specification 1.2).
#pragma once

#include "gpu/library.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace g3r::gpu::cl {

struct PlatformTag;
struct DeviceTag;
struct ContextTag;
struct QueueTag;
struct MemoryTag;
struct ProgramTag;
struct KernelTag;
struct EventTag;
using Platform = PlatformTag*;
using DeviceId = DeviceTag*;
using Context = ContextTag*;
using Queue = QueueTag*;
using Memory = MemoryTag*;
using ProgramId = ProgramTag*;
using KernelId = KernelTag*;
using Event = EventTag*;

inline constexpr std::int32_t kSuccess = 0;
inline constexpr std::uint32_t kFalse = 0;
inline constexpr std::uint32_t kTrue = 1;
inline constexpr std::uint64_t kDeviceTypeCpu = 1 << 1;
inline constexpr std::uint64_t kDeviceTypeAll = 0xFFFFFFFF;
inline constexpr std::uint64_t kReadWrite = 1 << 0;
inline constexpr std::uint64_t kAllocateHostMemory = 1 << 4;
inline constexpr std::uint64_t kMapReadAndWrite = 3;

// cl_platform_info, cl_device_info, cl_program_info, cl_program_build_info
inline constexpr std::uint32_t kPlatformVersion = 0x0901;
inline constexpr std::uint32_t kDeviceType = 0x1000;
inline constexpr std::uint32_t kDeviceMaxMemAllocSize = 0x1010;
inline constexpr std::uint32_t kDeviceGlobalMemSize = 0x101F;
inline constexpr std::uint32_t kDeviceLocalMemSize = 0x1023;
inline constexpr std::uint32_t kDeviceAvailable = 0x1027;
inline constexpr std::uint32_t kDeviceCompilerAvailable = 0x1028;
inline constexpr std::uint32_t kDeviceName = 0x102B;
inline constexpr std::uint32_t kDriverVersion = 0x102D;
inline constexpr std::uint32_t kDeviceExtensions = 0x1030;
inline constexpr std::uint32_t kDeviceNativeVectorWidthFloat = 0x103A;
inline constexpr std::uint32_t kDeviceNativeVectorWidthDouble = 0x103B;
inline constexpr std::uint32_t kProgramBinarySizes = 0x1165;
inline constexpr std::uint32_t kProgramBinaries = 0x1166;
inline constexpr std::uint32_t kProgramBuildLog = 0x1183;

/// Functions of libOpenCL. All are there, or none is used.
struct Api {
  std::int32_t (*get_platform_ids)(std::uint32_t, Platform*, std::uint32_t*);
  std::int32_t (*get_platform_info)(Platform, std::uint32_t, std::size_t, void*, std::size_t*);
  std::int32_t (*get_device_ids)(Platform, std::uint64_t, std::uint32_t, DeviceId*, std::uint32_t*);
  std::int32_t (*get_device_info)(DeviceId, std::uint32_t, std::size_t, void*, std::size_t*);
  Context (*create_context)(const std::intptr_t*, std::uint32_t, const DeviceId*, void (*)(const char*, const void*, std::size_t, void*),
                            void*, std::int32_t*);
  std::int32_t (*release_context)(Context);
  Queue (*create_command_queue)(Context, DeviceId, std::uint64_t, std::int32_t*);
  std::int32_t (*release_command_queue)(Queue);
  Memory (*create_buffer)(Context, std::uint64_t, std::size_t, void*, std::int32_t*);
  std::int32_t (*release_mem_object)(Memory);
  std::int32_t (*enqueue_write_buffer)(Queue, Memory, std::uint32_t, std::size_t, std::size_t, const void*, std::uint32_t, const Event*,
                                       Event*);
  std::int32_t (*enqueue_read_buffer)(Queue, Memory, std::uint32_t, std::size_t, std::size_t, void*, std::uint32_t, const Event*, Event*);
  void* (*enqueue_map_buffer)(Queue, Memory, std::uint32_t, std::uint64_t, std::size_t, std::size_t, std::uint32_t, const Event*, Event*,
                              std::int32_t*);
  std::int32_t (*enqueue_unmap)(Queue, Memory, void*, std::uint32_t, const Event*, Event*);
  std::int32_t (*wait_for_events)(std::uint32_t, const Event*);
  std::int32_t (*release_event)(Event);
  std::int32_t (*enqueue_nd_range_kernel)(Queue, KernelId, std::uint32_t, const std::size_t*, const std::size_t*, const std::size_t*,
                                          std::uint32_t, const Event*, Event*);
  std::int32_t (*finish)(Queue);
  ProgramId (*create_program_with_source)(Context, std::uint32_t, const char**, const std::size_t*, std::int32_t*);
  ProgramId (*create_program_with_binary)(Context, std::uint32_t, const DeviceId*, const std::size_t*, const unsigned char**, std::int32_t*,
                                          std::int32_t*);
  std::int32_t (*build_program)(ProgramId, std::uint32_t, const DeviceId*, const char*, void (*)(ProgramId, void*), void*);
  std::int32_t (*get_program_info)(ProgramId, std::uint32_t, std::size_t, void*, std::size_t*);
  std::int32_t (*get_program_build_info)(ProgramId, DeviceId, std::uint32_t, std::size_t, void*, std::size_t*);
  std::int32_t (*release_program)(ProgramId);
  KernelId (*create_kernel)(ProgramId, const char*, std::int32_t*);
  std::int32_t (*set_kernel_arg)(KernelId, std::uint32_t, std::size_t, const void*);
  std::int32_t (*release_kernel)(KernelId);
  std::string loader;  ///< the file of libOpenCL

  bool load() {
    const Library library({"libOpenCL.so.1", "libOpenCL.so", "OpenCL.dll"});
    loader = library.file_of("clGetPlatformIDs");
    return library.find("clGetPlatformIDs", get_platform_ids) && library.find("clGetPlatformInfo", get_platform_info) &&
           library.find("clGetDeviceIDs", get_device_ids) && library.find("clGetDeviceInfo", get_device_info) &&
           library.find("clCreateContext", create_context) && library.find("clReleaseContext", release_context) &&
           library.find("clCreateCommandQueue", create_command_queue) && library.find("clReleaseCommandQueue", release_command_queue) &&
           library.find("clCreateBuffer", create_buffer) && library.find("clReleaseMemObject", release_mem_object) &&
           library.find("clEnqueueWriteBuffer", enqueue_write_buffer) && library.find("clEnqueueReadBuffer", enqueue_read_buffer) &&
           library.find("clEnqueueMapBuffer", enqueue_map_buffer) && library.find("clEnqueueUnmapMemObject", enqueue_unmap) &&
           library.find("clWaitForEvents", wait_for_events) && library.find("clReleaseEvent", release_event) &&
           library.find("clEnqueueNDRangeKernel", enqueue_nd_range_kernel) && library.find("clFinish", finish) &&
           library.find("clCreateProgramWithSource", create_program_with_source) &&
           library.find("clCreateProgramWithBinary", create_program_with_binary) && library.find("clBuildProgram", build_program) &&
           library.find("clGetProgramInfo", get_program_info) && library.find("clGetProgramBuildInfo", get_program_build_info) &&
           library.find("clReleaseProgram", release_program) && library.find("clCreateKernel", create_kernel) &&
           library.find("clSetKernelArg", set_kernel_arg) && library.find("clReleaseKernel", release_kernel);
  }
};

}  // namespace g3r::gpu::cl
