// Every kernel in the flavour of CUDA compiles to PTX for the architectures that are in use. Skipped (77) without NVRTC, which the package
// nvidia-cuda-nvrtc-cu12 of PyPI has; no GPU is needed.
#include "gpu/nvrtc.h"
#include "gpu/device.h"
#include "gpu/kernel_source.h"
#include "sanitized.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

namespace g3r {
namespace {

std::vector<int> architectures() {
  const std::vector<int> supported = gpu::nvrtc_architectures();
  std::vector<int> out;
  for (const int wanted : {70, 80, 90}) {
    if (std::find(supported.begin(), supported.end(), wanted) != supported.end()) out.push_back(wanted);
    if (kSanitized && !out.empty()) break;  // the texts are the same for all, and what NVRTC makes of them is not ours
  }
  return out;
}

void expect_kernels(const std::string& source, int architecture, std::initializer_list<const char*> names) {
  const std::string ptx = gpu::compile_ptx(source, architecture);
  EXPECT_NE(ptx.find(".target sm_" + std::to_string(architecture)), std::string::npos);
  for (const char* name : names) EXPECT_NE(ptx.find(std::string(".entry ") + name), std::string::npos) << name;
}

TEST(Nvrtc, EveryKernelCompilesForEveryArchitecture) {
  using cpu::NearForm;
  ASSERT_FALSE(architectures().empty()) << "NVRTC " << gpu::nvrtc_version() << " knows none of sm_70, sm_80, sm_90";
  for (const int architecture : architectures()) {
    for (const NearForm form : {NearForm::kGreen, NearForm::kGreenAdjoint, NearForm::kStokesWinding, NearForm::kWinding,
                                NearForm::kWindingAdjoint, NearForm::kWindingGradient}) {
      const bool batches = form == NearForm::kGreen || form == NearForm::kGreenAdjoint;
      for (const int batch : {1, 4, 9}) {
        if (batch > 1 && !batches) continue;
        for (const bool local_widths : {false, true}) {
          for (const bool doubles : {false, true}) {
            const bool usual = !doubles && !local_widths;
            if (batch == 4 && !usual) continue;  // differs in numbers only
            if ((kSanitized || architecture != architectures().front()) && (!usual || (batches && batch != 9))) continue;
            gpu::KernelTraits traits;
            traits.form = form;
            traits.batch = batch;
            traits.local_widths = local_widths;
            traits.doubles = doubles;
            SCOPED_TRACE(testing::Message() << "sm_" << architecture << " form " << static_cast<int>(form) << " K " << batch << " widths "
                                            << local_widths << " double " << doubles);
            traits.rough = !doubles;
            expect_kernels(gpu::near_field_source(traits), architecture, {"near_field"});
            expect_kernels(gpu::expansions_source(traits), architecture, {"points_to_multipoles", "locals_to_points"});
            expect_kernels(gpu::translations_source(traits), architecture,
                           {"multipoles_to_parents", "locals_to_children", "multipoles_to_locals"});
          }
        }
      }
    }
  }
}

TEST(Nvrtc, VectorsOfASolveCompileForEveryArchitecture) {
  for (const int architecture : architectures()) {
    for (const bool doubles : {false, true}) {
      expect_kernels(gpu::vectors_source(doubles, false), architecture,
                     {"combine", "dot_of_blocks", "fill_vectors", "take_stokes_winding", "add_winding_adjoint", "fill_green", "take_green",
                      "add_green_adjoint"});
    }
  }
}

TEST(Nvrtc, NearestPointsCompileForEveryArchitecture) {
  for (const int architecture : architectures()) {
    for (const std::size_t k : {1UL, 17UL, 33UL}) expect_kernels(gpu::neighbours_source(k, 16, false), architecture, {"nearest_of_all"});
  }
}

TEST(Nvrtc, WhatDoesNotCompileIsSaidInALine) {
  try {
    (void)gpu::compile_ptx("this is no kernel\n", gpu::nvrtc_architectures().front());
    ADD_FAILURE() << "compiled";
  } catch (const gpu::DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("error"), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace g3r

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (!g3r::gpu::nvrtc_available()) {
    std::puts("skipped: no libnvrtc here; pip install nvidia-cuda-nvrtc-cu12 has one (put its folder into LD_LIBRARY_PATH)");
    return 77;
  }
  return RUN_ALL_TESTS();
}
