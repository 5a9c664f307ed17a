#include "io/las_output.h"
#include "io/laz.h"

namespace g3r::io {

bool laz_is_compiled() { return false; }

void require_laz(const Source& source) {
  fail_at_byte(source, las::kPointFormat,
               "a compressed LAZ file, which this build does not read; convert it, for example with \"laszip -i in.laz -o out.las\" or "
               "\"pdal translate in.laz out.las\", or build g3r with LASzip (tools/sources.sh)");
}

std::string unpack_laz(const Source& source, const LasHeader&, const ReadOptions&) {
  require_laz(source);
  return {};
}

struct LazRecords::State {};

LazRecords::LazRecords(const Source& head, const LasHeader&, const RandomFile&) { require_laz(head); }

LazRecords::~LazRecords() = default;

void LazRecords::next(std::size_t, std::string&) {}

const std::string& LazRecords::las_head() const {
  static const std::string kNone;
  return kNone;
}

std::uint64_t LazRecords::rest() const { return 0; }

std::unique_ptr<LasOutput> packed_las(OutputFile&) { throw Unavailable("write_cloud: this build does not write LAZ; write LAS (.las)"); }

}  // namespace g3r::io
