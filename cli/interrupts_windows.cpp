#include "interrupts.h"

#include <windows.h>

#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>

namespace g3r::cli {
namespace {

// What the handler, which Windows calls in a thread of its own, shares with the rest. Never destroyed: it may be running at the end.
struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::atomic<bool>* requested = nullptr;  // null: nobody is watching
  std::atomic<int>* exit_code = nullptr;
};

Shared& shared() {
  static auto* const state = new Shared;
  return *state;
}

}  // namespace

class Interrupts::Watch {
 public:
  explicit Watch(Interrupts& owner) {
    {
      const std::lock_guard lock(shared().mutex);
      shared().requested = &owner.requested_;
      shared().exit_code = &owner.exit_code_;
    }
    SetConsoleCtrlHandler(handle, TRUE);
  }
  ~Watch() {
    {
      const std::lock_guard lock(shared().mutex);
      shared().requested = nullptr;
      shared().exit_code = nullptr;
    }
    shared().changed.notify_all();
    SetConsoleCtrlHandler(handle, FALSE);
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  static BOOL WINAPI handle(DWORD event) {
    std::unique_lock lock(shared().mutex);
    if (shared().requested == nullptr) return FALSE;
    const int code = event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT ? kInterrupted : kTerminated;
    *shared().exit_code = code;
    *shared().requested = true;
    const auto is_done = [] { return shared().requested == nullptr; };
    if (shared().changed.wait_for(lock, std::chrono::milliseconds(kGraceMilliseconds), is_done)) return TRUE;
    DWORD written = 0;
    const char* const text = message(code);
    WriteFile(GetStdHandle(STD_ERROR_HANDLE), text, static_cast<DWORD>(std::strlen(text)), &written, nullptr);
    TerminateProcess(GetCurrentProcess(), static_cast<UINT>(code));
    return TRUE;
  }
};

Interrupts::Interrupts() : watch_(std::make_unique<Watch>(*this)) {}

Interrupts::~Interrupts() = default;

}  // namespace g3r::cli
