// The way to a GPU through CUDA's driver, with a driver that has none (fake_cuda.cpp): memory, programs, arguments, failures, and that
// everything is given back. Skipped (77) without NVRTC.
#include "gpu/cuda.h"
#include "gpu/nvrtc.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <numeric>

#include <dlfcn.h>

namespace g3r {
namespace {

constexpr const char* kSource = R"(
extern "C" __global__ void fill(float* p, float value, int n) {
  const int i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < n) p[i] = value;
}
)";

struct State {
  int buffers, modules, contexts, pushed, events, failure;
};

template <class Function>
Function* fake(const char* name) {
  return reinterpret_cast<Function*>(dlsym(dlopen("libcuda.so.1", RTLD_NOW), name));
}
const State& state() { return *fake<const State*()>("fake_cuda_state")(); }

void expect_all_given_back() {
  EXPECT_EQ(state().buffers, 0);
  EXPECT_EQ(state().modules, 0);
  EXPECT_EQ(state().contexts, 0);
  EXPECT_EQ(state().events, 0);
  EXPECT_EQ(state().pushed, 0) << "the thread's own context";
}

// The first elements of a buffer.
template <class T>
std::vector<T> read(gpu::Device& device, const gpu::Buffer& from, std::size_t count, std::size_t unit = 1) {
  std::vector<T> out(count);
  device.read(from, count * sizeof(T), unit * sizeof(T), [&](std::size_t offset, const unsigned char* data, std::size_t bytes) {
    EXPECT_TRUE(bytes % (unit * sizeof(T)) == 0 || offset + bytes == count * sizeof(T));
    std::memcpy(reinterpret_cast<unsigned char*>(out.data()) + offset, data, bytes);
  });
  return out;
}

std::string complaint(const std::function<void()>& work) {
  try {
    work();
  } catch (const gpu::DeviceError& error) {
    return error.what();
  }
  return "none";
}

TEST(CudaDriver, RunsWhatItIsGiven) {
  const std::vector<gpu::DeviceInfo> devices = gpu::cuda_devices();
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices[0].name, "Fake GPU");
  EXPECT_EQ(devices[0].driver, "CUDA 12.4, NVRTC " + gpu::nvrtc_version());
  EXPECT_FALSE(devices[0].software);
  for (const bool from_the_cache : {false, true}) {
    const std::shared_ptr<gpu::Device> device = gpu::open_cuda(devices[0]);
    const auto buffer = device->allocate(16);
    const std::vector<float> before{1, 2, 3, 4};
    device->write(*buffer, 0, before.data(), 16);
    device->write(*buffer, 12, before.data(), 4);
    device->launch(device->program(kSource).kernel("fill"), 2, 1, {*buffer, 5.0F, 3}, 0);
    device->finish();
    EXPECT_EQ(read<float>(*device, *buffer, 4), (std::vector<float>{5, 5, 3, 1})) << from_the_cache;
    EXPECT_EQ(state().pushed, 0);
  }
  expect_all_given_back();
}

TEST(CudaDriver, WhatIsTooLongForOneCopyGoesInParts) {
  {
    const std::shared_ptr<gpu::Device> device = gpu::open_cuda(gpu::cuda_devices().at(0));
    std::vector<std::uint32_t> numbers(6'000'001);  // 24 MB
    std::iota(numbers.begin(), numbers.end(), 7U);
    const auto buffer = device->allocate(numbers.size() * sizeof numbers[0]);
    device->write(*buffer, 0, numbers.data(), buffer->bytes());
    for (const std::size_t unit : {1UL, 12UL, 1000UL}) {
      EXPECT_EQ(read<std::uint32_t>(*device, *buffer, numbers.size(), unit), numbers);
    }
  }
  expect_all_given_back();
}

TEST(CudaDriver, FailuresAreErrorsInOneLine) {
  {
    const std::shared_ptr<gpu::Device> device = gpu::open_cuda(gpu::cuda_devices().at(0));
    EXPECT_THROW((void)device->allocate(std::size_t{1} << 40), gpu::OutOfMemory);
    EXPECT_EQ(complaint([&] { (void)device->allocate(std::size_t{1} << 40); }),
              "cannot allocate on the device: out of memory, 1048576 MB more than the 0 MB in use of 1024 MB");
    EXPECT_NE(complaint([&] { (void)device->program("no kernel"); }).find("cannot compile for the device: "), std::string::npos);
    EXPECT_NE(complaint([&] { (void)device->program(kSource).kernel("other"); }), "none");
    const auto buffer = device->allocate(16);
    gpu::Kernel& kernel = device->program(kSource).kernel("fill");
    fake<void(int)>("fake_cuda_fail")(700);  // as of a device that is lost
    EXPECT_EQ(complaint([&] {
                device->launch(kernel, 1, 1, {*buffer, 1.0F, 1}, 0);
              }),
              "cannot run a kernel: an illegal memory access was encountered");
    EXPECT_NE(complaint([&] { (void)read<float>(*device, *buffer, 1); }), "none");
    EXPECT_NE(complaint([&] { device->finish(); }), "none");
    EXPECT_EQ(state().pushed, 0);
    fake<void(int)>("fake_cuda_fail")(0);
  }
  expect_all_given_back();
}

}  // namespace
}  // namespace g3r

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::filesystem::path cache = std::filesystem::path(testing::TempDir()) / "g3r_cuda_cache";
  std::filesystem::remove_all(cache);
  setenv("XDG_CACHE_HOME", cache.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  if (!g3r::gpu::nvrtc_available()) {
    std::puts("skipped: no libnvrtc here");
    return 77;
  }
  const int result = RUN_ALL_TESTS();
  std::filesystem::remove_all(cache);
  return result;
}
