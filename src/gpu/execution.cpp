#include "gpu/execution.h"

#include <g3r/error.h>

namespace g3r::gpu {

void Execution::fail(const std::string& why) {
  const std::string text = device_->info().name + ": " + why;
  if (required_) throw Unavailable(text + "; without --device gpu the processor does the work");
  failure_ = text;
}

}  // namespace g3r::gpu
