// Where sums run: a device in use, and what happens when it fails. A SumPlan carries it; null stands for the processor.
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

  [[nodiscard]] Device& device() const { return *device_; }
  [[nodiscard]] std::shared_ptr<Device> shared_device() const { return device_; }
  /// Whether sums of this precision run on the device: it has not failed, and has doubles if they are needed.
  [[nodiscard]] bool usable(bool doubles) const { return failure_.empty() && (!doubles || device_->info().doubles); }
  /// Adds the time of a sum; seconds() is that of all.
  void add_seconds(double seconds) { seconds_ = seconds_ + seconds; }
  [[nodiscard]] double seconds() const { return seconds_; }
  /// Takes note that the device has failed. Throws Unavailable if it was required.
  void fail(const std::string& why);
  /// Why the processor took over; empty if it did not.
  [[nodiscard]] const std::string& failure() const { return failure_; }

 private:
  std::shared_ptr<Device> device_;
  bool required_;
  std::string failure_;
  std::atomic<double> seconds_ = 0;
};

}  // namespace g3r::gpu
