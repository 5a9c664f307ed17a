// Every kernel in the flavour of OpenCL C 1.2 compiles for a machine that is no processor (SPIR-V's), for all numbers of lanes, and without
// doubles where it needs none. Skipped (77) without clang, which compiles OpenCL C for machines that are not there.
#include "gpu/kernel_source.h"
#include "sanitized.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace g3r {
namespace {

// Unused are what some forms have no need of, and the functions of a text that is shared.
constexpr const char* kStrict = " -Wall -Wextra -Werror -Wno-unused-function -Wno-unused-variable -Wno-unused-parameter";
constexpr const char* kWithoutDoubles = " -w -Xclang -cl-ext=-cl_khr_fp64";

// What the compiler says of a source.
std::string complaints(const std::string& source, const std::string& options) {
  const std::filesystem::path folder = testing::TempDir();
  const std::filesystem::path file = folder / "g3r_opencl_source.cl";
  const std::filesystem::path log = folder / "g3r_opencl_source.log";
  std::ofstream(file) << source;
  const std::string command = std::string(G3R_CLANG) +
                              " -x cl -cl-std=CL1.2 -target spir64 -Xclang -finclude-default-header -fsyntax-only" + options + " '" +
                              file.string() + "' > '" + log.string() + "' 2>&1";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): a compiler that CMake has found
  std::ifstream in(log);
  std::string said((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  return status == 0 ? said : "failed: " + said;
}

void expect_compiles(const gpu::KernelTraits& traits) {
  SCOPED_TRACE(testing::Message() << "form " << static_cast<int>(traits.form) << " K " << traits.batch << " widths " << traits.local_widths
                                  << " double " << traits.doubles << " lanes " << traits.lanes);
  for (const std::string& source : {gpu::near_field_source(traits), gpu::expansions_source(traits), gpu::translations_source(traits)}) {
    EXPECT_EQ(complaints(source, kStrict), "");
    if (!traits.doubles) {
      EXPECT_EQ(complaints(source, kWithoutDoubles), "");
    }
  }
}

TEST(OpenClSource, KernelsOfAllFormsCompile) {
  using enum cpu::NearForm;
  for (const cpu::NearForm form : {kGreen, kGreenAdjoint, kStokesWinding, kWinding, kWindingAdjoint, kWindingGradient}) {
    for (const int batch : {1, 4, 9}) {
      if (batch > 1 && form != kGreen && form != kGreenAdjoint) continue;
      for (const bool local_widths : {false, true}) {
        for (const bool doubles : {false, true}) {
          if (kSanitized && (local_widths || doubles)) continue;
          gpu::KernelTraits traits;
          traits.form = form;
          traits.batch = batch;
          traits.local_widths = local_widths;
          traits.doubles = doubles;
          traits.rough = !doubles && !local_widths;
          expect_compiles(traits);
        }
      }
    }
  }
}

TEST(OpenClSource, KernelsCompileForAllNumbersOfLanes) {
  for (const std::size_t lanes : {2UL, 4UL, 8UL, 16UL}) {
    for (const cpu::NearForm form : {cpu::NearForm::kGreenAdjoint, cpu::NearForm::kStokesWinding}) {
      gpu::KernelTraits traits;
      traits.form = form;
      traits.local_widths = true;
      traits.lanes = lanes;
      expect_compiles(traits);
      traits.doubles = true;
      expect_compiles(traits);
    }
  }
}

TEST(OpenClSource, VectorsAndNeighboursCompile) {
  for (const bool software : {false, true}) {
    for (const bool doubles : {false, true}) EXPECT_EQ(complaints(gpu::vectors_source(doubles, software), kStrict), "");
    for (const std::size_t k : {1UL, 17UL}) EXPECT_EQ(complaints(gpu::neighbours_source(k, 16, software), kStrict), "");
  }
}

TEST(OpenClSource, WhatIsNoKernelDoesNotCompile) { EXPECT_NE(complaints("this is no kernel\n", kStrict), ""); }

}  // namespace
}  // namespace g3r

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (std::string(G3R_CLANG).empty() || !g3r::complaints("kernel void nothing(void) {}\n", "").empty()) {
    std::puts("skipped: no clang here that compiles OpenCL C");
    return 77;
  }
  return RUN_ALL_TESTS();
}
