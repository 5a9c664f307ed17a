// The whole program on one page: one line per step.
#include <g3r/g3r.h>

namespace g3r {

std::string_view version() { return "0.1.0"; }

}  // namespace g3r
