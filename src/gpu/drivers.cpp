// Source: Khronos, cl_khr_icd, and ocl-icd's manual for the variable.
#include "gpu/drivers.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace g3r::gpu {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnd = ".icd";

// The first line of a file is a name.
void add_file(const fs::path& file, std::vector<std::string>& drivers) {
  std::ifstream in(file);
  std::string name;
  if (in >> name) drivers.push_back(name);
}

void add_folder(const fs::path& folder, std::vector<std::string>& drivers) {
  std::error_code error;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    if (i->path().extension() == kEnd) add_file(i->path(), drivers);
  }
}

}  // namespace

std::vector<std::string> listed_drivers(const std::string& loader) {
  std::vector<std::string> drivers;
  const char* variable = std::getenv("OCL_ICD_VENDORS");  // NOLINT(concurrency-mt-unsafe): nothing here sets variables
  if (variable != nullptr && *variable != '\0') {
    const fs::path vendors(variable);
    std::error_code error;
    if (fs::is_directory(vendors, error)) {
      add_folder(vendors, drivers);
    } else if (vendors.extension() == kEnd) {
      add_file(vendors, drivers);
    } else {
      drivers.push_back(variable);
    }
  } else if (!loader.empty()) {
    for (fs::path folder = fs::path(loader).parent_path();; folder = folder.parent_path()) {
      add_folder(folder / "etc/OpenCL/vendors", drivers);
      if (folder == folder.parent_path()) break;
    }
  }
  return drivers;
}

bool only_software(const std::vector<std::string>& drivers) {
  const auto is_pocl = [](const std::string& driver) { return fs::path(driver).filename().string().starts_with("libpocl"); };
  return !drivers.empty() && std::all_of(drivers.begin(), drivers.end(), is_pocl);
}

}  // namespace g3r::gpu
