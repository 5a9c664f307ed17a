// One run of a command: its console, its clock, its way to be cancelled.
#pragma once

#include <g3r/g3r.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "console.h"
#include "interrupts.h"
#include "settings.h"

namespace g3r::cli {

class Session {
 public:
  Session(const Settings& settings, const Interrupts& interrupts)
      : console_(settings.quiet, settings.progress, settings.verbosity), interrupts_(interrupts), start_(Clock::now()) {}

  [[nodiscard]] Console& console() { return console_; }

  /// Progress and cancellation for a call of the library.
  [[nodiscard]] Monitor monitor();

  /// The options with the way to be cancelled. What they warn of becomes part of the summary.
  [[nodiscard]] WriteOptions cancellable(WriteOptions options) {
    options.cancel = &interrupts_.requested();
    options.warnings = &write_warnings_;
    return options;
  }
  /// What the files written so far could not take as it is.
  [[nodiscard]] const std::vector<std::string>& write_warnings() const { return write_warnings_; }
  [[nodiscard]] ReadOptions cancellable(ReadOptions options) const {
    options.cancel = &interrupts_.requested();
    return options;
  }

  /// Does `work`, shows `name` meanwhile and remembers the time it took. Throws Cancelled instead if the user has asked to stop.
  template <class Work>
  auto stage(const std::string& name, Work&& work) {
    if (interrupts_.requested()) throw Cancelled();
    console_.progress(name, 0);
    const Timer timer{*this, name, Clock::now()};
    return std::forward<Work>(work)();
  }

  /// Adds to `stats` what only the program knows: the times of its own stages, the whole time, the peak of memory and warnings of writers.
  void complete(Stats& stats) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Timer {
    Session& session;
    std::string name;
    Clock::time_point start;
    ~Timer() { session.seconds_.emplace_back(name, std::chrono::duration<double>(Clock::now() - start).count()); }
  };

  Console console_;
  const Interrupts& interrupts_;
  Clock::time_point start_;
  std::vector<std::pair<std::string, double>> seconds_;
  std::vector<std::string> write_warnings_;
};

}  // namespace g3r::cli
