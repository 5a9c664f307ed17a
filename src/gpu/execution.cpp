#include "gpu/execution.h"

#include <g3r/error.h>

#include <utility>

namespace g3r::gpu {
namespace {

thread_local std::shared_ptr<Execution> current_execution;

}  // namespace

const std::shared_ptr<Execution>& Execution::current() { return current_execution; }

Placed::Placed(std::shared_ptr<Execution> execution) : before_(std::exchange(current_execution, std::move(execution))) {}
Placed::~Placed() { current_execution = std::move(before_); }

void Execution::fail(const std::string& why) {
  const std::string text = device_->info().name + ": " + why;
  sound_ = false;
  if (required_) throw Unavailable(text + "; without --device gpu the processor does the work");
  if (failed_) return;
  failure_ = text;
  failed_ = true;
}

}  // namespace g3r::gpu
