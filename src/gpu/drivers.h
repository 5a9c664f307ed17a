// The drivers that OpenCL would load, from the files that name them, without loading any. Internal to src/gpu.
#pragma once

#include <string>
#include <vector>

namespace g3r::gpu {

/// The libraries that the files *.icd name for the loader in this file ("/usr/lib/x86_64-linux-gnu/libOpenCL.so.1"), each a name or a path:
/// those of $OCL_ICD_VENDORS, or else of $OPENCL_VENDOR_PATH (a folder, a file or a library), else of etc/OpenCL/vendors in every folder
/// above the loader. None where drivers are listed elsewhere: in $OCL_ICD_FILENAMES, or in the registry of Windows.
[[nodiscard]] std::vector<std::string> listed_drivers(const std::string& loader);

/// True where no driver but PoCL is listed, whose devices are processors.
[[nodiscard]] bool only_software(const std::vector<std::string>& drivers);

}  // namespace g3r::gpu
