#include "io/laz.h"

namespace g3r::io {

void require_laz(const Source& source) {
  fail_at_byte(source, las::kPointFormat,
               "a compressed LAZ file, which this build does not read; convert it, for example with \"laszip -i in.laz -o out.las\" or "
               "\"pdal translate in.laz out.las\", or build g3r with LASzip (tools/sources.sh)");
}

std::string unpack_laz(const Source& source, const LasHeader&) {
  require_laz(source);
  return {};
}

}  // namespace g3r::io
