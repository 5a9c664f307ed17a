#include "io/readers.h"

namespace g3r::io {

Cloud read_e57(const Source& source) {
  fail(source,
       "an E57 file, which this build does not read; convert it, for example with \"pdal translate in.e57 out.las\" or CloudCompare, or "
       "build g3r with libE57Format (-DG3R_E57_SOURCE=DIR)");
}

}  // namespace g3r::io
