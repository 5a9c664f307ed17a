// Ctrl-C and SIGTERM: asked politely first, then enforced.
#pragma once

#include <atomic>
#include <thread>

namespace g3r::cli {

/// From construction to destruction the first SIGINT or SIGTERM raises the flag that the library watches. If the program is still there
/// kGraceMilliseconds later (inside a step that cannot be cancelled) it is ended with the same exit code. Outputs are renamed into place
/// when they are complete, so ending the program at any moment leaves no half file.
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
  void wait();

  std::atomic<bool> requested_ = false;
  std::atomic<int> exit_code_;
  std::thread waiter_;
};

}  // namespace g3r::cli
