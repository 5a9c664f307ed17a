#include "session.h"

#include "base/platform.h"

#include <algorithm>

namespace g3r::cli {

Monitor Session::monitor() {
  Monitor monitor;
  monitor.cancel = &interrupts_.requested();
  monitor.progress = [this](std::string_view stage, double fraction) {
    console_.progress(stage, fraction);
    return !interrupts_.requested();
  };
  return monitor;
}

void Session::complete(Stats& stats) const {
  for (const std::string& warning : write_warnings_) {
    if (std::find(stats.warnings.begin(), stats.warnings.end(), warning) == stats.warnings.end()) stats.warnings.push_back(warning);
  }
  stats.seconds.insert(stats.seconds.end(), seconds_.begin(), seconds_.end());
  std::erase_if(stats.seconds, [](const auto& entry) { return entry.first == "total"; });
  stats.seconds.emplace_back("total", std::chrono::duration<double>(Clock::now() - start_).count());
  stats.peak_memory_bytes = std::max(stats.peak_memory_bytes, platform::peak_memory());
}

}  // namespace g3r::cli
