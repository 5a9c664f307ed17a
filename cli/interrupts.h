// Ctrl-C and SIGTERM: asked politely first, then enforced. One source per kind of system: interrupts_posix.cpp, interrupts_windows.cpp.
#pragma once

#include <atomic>
#include <memory>

#include "exit_code.h"

namespace g3r::cli {

/// From construction to destruction the first SIGINT or SIGTERM raises the flag that the library watches. If the program is still there
/// kGraceMilliseconds later (inside a step that cannot be cancelled) it is ended with the same exit code. Outputs are renamed into place
/// when they are complete, so ending the program at any moment leaves no half file. On Windows these are Ctrl-C or Ctrl-Break, and the end
/// of the console, the session or the system.
/// Construct before any other thread exists: the signals are blocked in all of them and received by one thread of this class.
/// A signal that is ignored at the start (nohup, a background job) stays ignored.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  [[nodiscard]] const std::atomic<bool>& requested() const { return requested_; }
  /// kInterrupted or kTerminated, by the signal that came.
  [[nodiscard]] int exit_code() const { return exit_code_; }

 private:
  class Watch;

  // People notice half a second. The library stops within a tenth of this; meshing and file access may take longer.
  static constexpr int kGraceMilliseconds = 350;
  static constexpr const char* message(int code) { return code == kTerminated ? "\ng3r: terminated\n" : "\ng3r: interrupted\n"; }

  std::atomic<bool> requested_ = false;
  std::atomic<int> exit_code_ = kInterrupted;
  std::unique_ptr<Watch> watch_;
};

}  // namespace g3r::cli
