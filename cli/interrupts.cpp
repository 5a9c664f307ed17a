#include "interrupts.h"

#include <csignal>
#include <ctime>
#include <string_view>

#include <pthread.h>
#include <unistd.h>

#include "exit_code.h"

namespace g3r::cli {
namespace {

// People notice half a second. The library stops within a tenth of this; meshing and file access may take longer.
constexpr long kGraceMilliseconds = 350;

// Wakes the waiting thread at the end of the program. Ignored by default, so a stray one does no harm.
constexpr int kWakeSignal = SIGURG;

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, kWakeSignal);
  for (const int signal : {SIGINT, SIGTERM}) {
    if (!is_ignored(signal)) sigaddset(&set, signal);
  }
  return set;
}

}  // namespace

Interrupts::Interrupts() : exit_code_(kInterrupted) {
  // A closed pipe is an error of the write, not the end of the program: `g3r a.ply b.ply 2>&1 | head` still writes b.ply.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // likewise a file that grows beyond the limit of the user
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  waiter_ = std::thread([this] { wait(); });
}

Interrupts::~Interrupts() {
  pthread_kill(waiter_.native_handle(), kWakeSignal);
  waiter_.join();
}

void Interrupts::wait() {
  const sigset_t set = watched_signals();
  int signal = 0;
  while (sigwait(&set, &signal) != 0) {
  }
  if (signal == kWakeSignal) return;
  exit_code_ = signal == SIGTERM ? kTerminated : kInterrupted;
  requested_ = true;

  sigset_t wake;
  sigemptyset(&wake);
  sigaddset(&wake, kWakeSignal);
  const timespec grace{0, kGraceMilliseconds * 1'000'000};
  if (sigtimedwait(&wake, nullptr, &grace) == kWakeSignal) return;
  constexpr std::string_view kMessage = "\ng3r: interrupted\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage.data(), kMessage.size());
  _exit(exit_code_);
}

}  // namespace g3r::cli
