// Loops on the calling thread: the back end without threads, for machines that have none (browsers). The same blocks in the same order of
// addition as with threads, and therefore the same bytes.
#include "cpu/parallel.h"

#include "cpu/parallel_apart.h"

namespace g3r::parallel {

int thread_count(int /*threads*/) { return 1; }

void run_with_threads(int /*threads*/, FunctionRef<> work) { work(); }

void apart(FunctionRef<> work) { work(); }

void for_ranges(std::size_t count, FunctionRef<std::size_t, std::size_t> body) { body(0, count); }

}  // namespace g3r::parallel
