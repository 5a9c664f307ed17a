// Where a call's work runs: a device in use, and what happens when it fails. A SumPlan carries it; null stands for the processor.
#pragma once

#include "gpu/device.h"

#include <atomic>
#include <memory>
#include <string>

namespace g3r::gpu {

class Execution {
 public:
  /// `required`: failures throw Unavailable; otherwise the processor takes over.
  Execution(std::shared_ptr<Device> device, bool required) : device_(std::move(device)), required_(required) {}

  /// That of the innermost Placed of this thread; null: the processor.
  [[nodiscard]] static const std::shared_ptr<Execution>& current();

  [[nodiscard]] Device& device() const { return *device_; }
  [[nodiscard]] std::shared_ptr<Device> shared_device() const { return device_; }
  /// Whether work of this precision runs on the device: it has not failed, and has doubles if they are needed.
  [[nodiscard]] bool usable(bool doubles) const { return !failed_ && (!doubles || device_->info().doubles); }
  /// Adds the time of a piece of work; seconds() is that of all.
  void add_seconds(double seconds) { seconds_ = seconds_ + seconds; }
  [[nodiscard]] double seconds() const { return seconds_; }
  /// Takes note that the device has failed, within its alone(). Throws Unavailable if it was required.
  void fail(const std::string& why);
  /// Whether the device has never failed, required or not: another call may use it.
  [[nodiscard]] bool sound() const { return sound_; }
  /// Why the processor took over; empty if it did not.
  [[nodiscard]] std::string failure() const { return failed_ ? failure_ : std::string(); }

 private:
  std::shared_ptr<Device> device_;
  bool required_;
  std::string failure_;  // not read before failed_ is set, nor changed after
  std::atomic<bool> failed_ = false;
  std::atomic<bool> sound_ = true;
  std::atomic<double> seconds_ = 0;
};

/// Makes an Execution the current one of this thread as long as it lives.
class Placed {
 public:
  explicit Placed(std::shared_ptr<Execution> execution);
  ~Placed();
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;

 private:
  std::shared_ptr<Execution> before_;
};

}  // namespace g3r::gpu
