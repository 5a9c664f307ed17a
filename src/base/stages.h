// The clock, progress and cancellation of one run.
#pragma once

#include "base/platform.h"

#include <g3r/g3r.h>

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace g3r {

/// Times consecutive stages and talks to the caller's Monitor. All members throw Cancelled when the caller wants to stop.
class Stages {
 public:
  explicit Stages(const Monitor& monitor) : monitor_(monitor), stage_start_(Clock::now()) {}

  /// `total`: seconds that a device has worked so far.
  void time_device(std::function<double()> total) {
    device_total_ = std::move(total);
    device_start_ = device_total_();
  }
  void begin(const std::string& stage) {
    end_stage();
    stage_ = stage;
    progress(0);
  }
  void progress(double fraction) {
    fraction_ = fraction;
    still_going();
  }
  /// Progress that nothing is known of: callers get a chance to cancel.
  void still_going() {
    check();
    if (monitor_.progress && !monitor_.progress(stage_, fraction_)) throw Cancelled();
  }
  void check() const {
    if (monitor_.cancel != nullptr && monitor_.cancel->load(std::memory_order_relaxed)) throw Cancelled();
  }
  [[nodiscard]] const std::atomic<bool>* cancel() const { return monitor_.cancel; }

  /// Ends the last stage and writes times and peak memory.
  void finish(Stats& stats) {
    progress(1);
    end_stage();
    stats.seconds.insert(stats.seconds.end(), seconds_.begin(), seconds_.end());
    stats.device_seconds.insert(stats.device_seconds.end(), device_seconds_.begin(), device_seconds_.end());
    seconds_.clear();
    device_seconds_.clear();
    stats.peak_memory_bytes = platform::peak_memory();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void end_stage() {
    const Clock::time_point now = Clock::now();
    if (!stage_.empty()) seconds_.emplace_back(stage_, std::chrono::duration<double>(now - stage_start_).count());
    const double on_device = device_total_ ? device_total_() : 0;
    if (!stage_.empty() && on_device > device_start_) device_seconds_.emplace_back(stage_, on_device - device_start_);
    stage_start_ = now;
    device_start_ = on_device;
    stage_.clear();
  }

  const Monitor& monitor_;
  Clock::time_point stage_start_;
  std::string stage_;
  double fraction_ = 0;
  std::vector<std::pair<std::string, double>> seconds_;
  std::function<double()> device_total_;  // empty: none is timed
  double device_start_ = 0;               // what it was when the stage began
  std::vector<std::pair<std::string, double>> device_seconds_;
};

}  // namespace g3r
