// Options::device: which device the sums of a call run on. Solver, refinement and mesher name none: every FastSum made within a Scope, on
// its thread, runs there.
#pragma once

#include "gpu/execution.h"

#include <g3r/g3r.h>

#include <cstddef>
#include <memory>
#include <string>

namespace g3r::gpu {

/// From its construction to its end. A Scope within another one that asks for the same shares its device.
class Scope {
 public:
  /// `request`: Options::device; `points`: of the call, which "auto" goes by. Throws InvalidInput for another word, Unavailable for a
  /// device that was asked for and is not there, does not work, or computes wrong sums.
  Scope(const std::string& request, std::size_t points);
  ~Scope();
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;

  /// The device of the innermost Scope of this thread; null: the processor.
  [[nodiscard]] static std::shared_ptr<Execution> current();

  /// Wall clock seconds that sums on its device have taken since it was opened by this call.
  [[nodiscard]] double seconds() const { return execution_ != nullptr ? execution_->seconds() : 0; }
  /// Device and driver into `stats`, and a warning if the processor had to take over.
  void describe(Stats& stats) const;

 private:
  std::string request_;
  std::shared_ptr<Execution> execution_;
  bool opened_ = false;  // by this Scope, not by an outer one
  std::string note_;     // why "auto" did not take the device that is there
  Scope* outer_;
};

}  // namespace g3r::gpu
