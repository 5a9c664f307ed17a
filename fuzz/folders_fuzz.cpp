// libFuzzer target for what names other files: lists, virtual point clouds, EPT and the manifest of a work folder of tiles. The first byte
// says which (g3r::fuzz::Naming), the rest is that file; the files around it are sound and small.
#include "folders_fuzz.h"

#include "io/ept.h"
#include "io/file_lists.h"

#include <g3r/error.h>
#include <g3r/tiles.h>

#include "require.h"

namespace {

using g3r::fuzz::Naming;

const g3r::samples::Folder& folder() {
  static const g3r::samples::Folder made;
  return made;
}

void read(Naming naming) {
  switch (naming) {
    case Naming::kList:
    case Naming::kVirtual:
      (void)g3r::io::files_of_list(folder().path(g3r::fuzz::file_of(naming)));
      break;
    case Naming::kEpt:
    case Naming::kEptPage:
      (void)g3r::io::read_ept(folder().path(g3r::fuzz::file_of(Naming::kEpt)), {});
      break;
    case Naming::kManifest:
      (void)g3r::tiles_status(folder().path(""));
      (void)g3r::tiles::read_cells(folder().path(""), g3r::tiles::read_manifest(folder().path("")));
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  g3r::fuzz::make_plan(folder());
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0 || data[0] > static_cast<unsigned char>(Naming::kManifest)) return -1;
  const auto naming = static_cast<Naming>(data[0]);
  if (naming == Naming::kEpt || naming == Naming::kEptPage) g3r::fuzz::make_ept(folder());
  g3r::samples::spill(folder().path(g3r::fuzz::file_of(naming)), {reinterpret_cast<const char*>(data) + 1, size - 1});
  const std::size_t constant =
      naming == Naming::kManifest ? std::size_t{64} << 20 : std::size_t{1} << 20;  // the folder of a plan is trusted
  const g3r::fuzz::MemoryLaw law(16 * size, constant);
  try {
    read(naming);
  } catch (const g3r::InvalidInput&) {
  } catch (const g3r::IoError&) {  // names of files that are not there
  }
  return 0;
}
