// Options::device: which device the work of a call runs on. Solver, refinement and mesher name none: every FastSum made within a Scope, on
// its thread, runs there.
#pragma once

#include "gpu/execution.h"

#include <g3r/g3r.h>

#include <cstddef>
#include <memory>
#include <string>

namespace g3r::gpu {

/// A device that is chosen, opened and tried out, for one caller until its end.
class Lease {
 public:
  /// `request`: Options::device; `points`: of the call, which "auto" goes by. Throws InvalidInput for another word, Unavailable for a
  /// device that was asked for and is not there, does not work, or computes wrong sums.
  Lease(const std::string& request, std::size_t points);
  ~Lease();
  Lease(Lease&&) noexcept = default;
  Lease& operator=(Lease&&) = delete;

  /// Null: the processor.
  [[nodiscard]] const std::shared_ptr<Execution>& execution() const { return execution_; }
  /// Why "auto" did not take the device that is there.
  [[nodiscard]] const std::string& note() const { return note_; }

 private:
  std::shared_ptr<Execution> execution_;
  std::string note_;
};

/// Execution::current() from its construction to its end. A Scope within another one that asks for the same shares its device.
class Scope {
 public:
  /// As a Lease.
  Scope(const std::string& request, std::size_t points);
  ~Scope();
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;

  /// The device of the innermost Scope of this thread; null: the processor.
  [[nodiscard]] static std::shared_ptr<Execution> current() { return Execution::current(); }

  /// Wall clock seconds that work on its device has taken since it was opened by this call.
  [[nodiscard]] double seconds() const { return execution() != nullptr ? execution()->seconds() : 0; }
  /// Device and driver into `stats`, and a warning if the processor had to take over.
  void describe(Stats& stats) const;

 private:
  [[nodiscard]] const std::shared_ptr<Execution>& execution() const { return lease_->execution(); }

  std::string request_;
  std::shared_ptr<const Lease> lease_;  // its own, or that of an outer one
  Placed placed_;
  Scope* outer_;
};

}  // namespace g3r::gpu
