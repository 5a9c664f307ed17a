#include "interrupts.h"

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <string_view>
#include <thread>

#include <pthread.h>
#include <unistd.h>

namespace g3r::cli {
namespace {

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

class Interrupts::Watch {
 public:
  explicit Watch(Interrupts& owner) : owner_(owner) {
    const sigset_t set = watched_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    waiter_ = std::thread([this] { wait(); });
  }
  ~Watch() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    changed_.notify_all();
    pthread_kill(waiter_.native_handle(), kWakeSignal);
    waiter_.join();
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  void wait() {
    const sigset_t set = watched_signals();
    int signal = 0;
    while (sigwait(&set, &signal) != 0) {
    }
    if (signal == kWakeSignal) return;
    owner_.exit_code_ = signal == SIGTERM ? kTerminated : kInterrupted;
    owner_.requested_ = true;

    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, std::chrono::milliseconds(kGraceMilliseconds), [this] { return done_; })) return;
    const std::string_view text = message(owner_.exit_code_);
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
    _exit(owner_.exit_code_);
  }

  Interrupts& owner_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::thread waiter_;
};

Interrupts::Interrupts() {
  // A closed pipe is an error of the write, not the end of the program: `g3r a.ply b.ply 2>&1 | head` still writes b.ply.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // likewise a file that grows beyond the limit of the user
  watch_ = std::make_unique<Watch>(*this);
}

Interrupts::~Interrupts() = default;

}  // namespace g3r::cli
