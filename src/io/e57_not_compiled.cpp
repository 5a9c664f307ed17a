#include "io/readers.h"

namespace g3r::io {

Cloud read_e57(const Source& source) {
  fail(source,
       "an E57 file, which this build does not read; convert it, for example with \"pdal translate in.e57 out.las\" or CloudCompare, or "
       "build g3r with libE57Format (tools/sources.sh)");
}

std::unique_ptr<PointStream> stream_e57(std::unique_ptr<RandomFile> file) {
  read_e57({{}, file->path()});
  return nullptr;
}

}  // namespace g3r::io
