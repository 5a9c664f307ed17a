// Sources: Khronos, cl_khr_icd, and the manuals of its loader and of ocl-icd for the variables.
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

std::string variable(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing here sets variables
  return value == nullptr ? std::string() : std::string(value);
}

}  // namespace

std::vector<std::string> listed_drivers(const std::string& loader) {
  if (!variable("OCL_ICD_FILENAMES").empty()) return {};  // drivers besides, for some loaders
  std::vector<std::string> drivers;
  std::string given = variable("OCL_ICD_VENDORS");
  if (given.empty()) given = variable("OPENCL_VENDOR_PATH");
  if (!given.empty()) {
    const fs::path vendors(given);
    std::error_code error;
    if (fs::is_directory(vendors, error)) {
      add_folder(vendors, drivers);
    } else if (vendors.extension() == kEnd) {
      add_file(vendors, drivers);
    } else {
      drivers.push_back(given);
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
