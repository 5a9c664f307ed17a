// Work that holds a lock while its loops run (cpu/parallel.h).
#pragma once

#include "cpu/parallel.h"

namespace g3r::parallel {

/// Runs work(). While it waits for the ends of its loops, the thread takes up nothing else: no task of a caller's own loop, which may want
/// a lock that work() holds.
void apart(FunctionRef<> work);

}  // namespace g3r::parallel
