#include <g3r/g3r.h>

#include "cpu/near_field.h"
#include "gpu/library.h"

namespace g3r {

std::string_view version() { return G3R_VERSION; }

BuildInfo build_info() {
  BuildInfo info;
  info.laz = G3R_HAS_LAZ;
  info.e57 = G3R_HAS_E57;
  info.poisson = G3R_HAS_OPEN3D;
  info.instruction_set = cpu::instruction_set();
  info.opencl = gpu::Library({"libOpenCL.so.1", "libOpenCL.so", "OpenCL.dll"}).loaded();
  info.cuda = gpu::Library({"libcuda.so.1", "nvcuda.dll"}).loaded();
  return info;
}

}  // namespace g3r
