// A driver of OpenCL that has no device, for gpu_failures_test: tells that it was loaded.
#include <cstdlib>

namespace {

[[maybe_unused]] const int told = setenv("G3R_FAKE_ICD", "loaded", 1);  // NOLINT(concurrency-mt-unsafe): one thread

}  // namespace
