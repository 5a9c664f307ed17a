// Loops on oneTBB: the back end with threads. Beside cpu/parallel_sort.h the only file that names that library.
#include "cpu/parallel.h"

#include "cpu/parallel_apart.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace g3r::parallel {
namespace {

// Tell ThreadSanitizer, which cannot see into the threading library, that what threads did before signal() is visible to one that has
// called wait() since. One address serves all loops: a loop body can be told before it has read anything.
#ifdef __SANITIZE_THREAD__
const char handed_over = 0;
void signal() { __tsan_release(const_cast<char*>(&handed_over)); }
void wait() { __tsan_acquire(const_cast<char*>(&handed_over)); }
#else
void signal() {}
void wait() {}
#endif

// Arenas that wait for their next call. oneTBB does not give back all of an arena of several threads, some 7 KiB, so that a process that
// calls again and again would grow without end if each call made its own. A call has its arena to itself. Slots instead of a lock: in the
// child of a fork nobody would unlock it. Never destroyed: at the end of a process, calls in other threads may still be running.
class IdleArenas {
 public:
  [[nodiscard]] std::unique_ptr<tbb::task_arena> take(int threads) {
    for (std::atomic<tbb::task_arena*>& slot : slots_) {
      std::unique_ptr<tbb::task_arena> arena(slot.exchange(nullptr));
      if (arena != nullptr && arena->max_concurrency() == threads) return arena;
      give(std::move(arena));
    }
    return std::make_unique<tbb::task_arena>(threads);
  }
  void give(std::unique_ptr<tbb::task_arena> arena) noexcept {
    for (std::atomic<tbb::task_arena*>& slot : slots_) {
      tbb::task_arena* empty = nullptr;
      if (arena == nullptr || slot.compare_exchange_strong(empty, arena.get())) {
        (void)arena.release();
        return;
      }
    }
  }

 private:
  static constexpr std::size_t kCallers = 16;  // calls at once whose arenas are kept; those of more are made anew
  std::array<std::atomic<tbb::task_arena*>, kCallers> slots_{};
};

IdleArenas& idle_arenas() {
  static auto* const arenas = new IdleArenas;
  return *arenas;
}

// The body of a loop as oneTBB hands it out: copied into a task, after the range of the task, by one thread, and called by another.
class LoopTask {
 public:
  explicit LoopTask(const FunctionRef<std::size_t, std::size_t>& body) : body_(&body) {}
  LoopTask(const LoopTask& other) : body_(other.body_in_sight()) { signal(); }
  LoopTask& operator=(const LoopTask&) = delete;
  ~LoopTask() = default;
  void operator()(const tbb::blocked_range<std::size_t>& range) const {
    wait();
    (*body_)(range.begin(), range.end());
    signal();
  }

 private:
  // Before anything of the copy is written: its memory may have been that of another task.
  [[nodiscard]] const FunctionRef<std::size_t, std::size_t>* body_in_sight() const {
    wait();
    return body_;
  }

  const FunctionRef<std::size_t, std::size_t>* body_;
};

}  // namespace

int thread_count(int threads) {
  const int cores = tbb::info::default_concurrency();
  return threads > 0 ? std::min(threads, cores) : cores;
}

void run_with_threads(int threads, FunctionRef<> work) {
  struct Loan {
    std::unique_ptr<tbb::task_arena> arena;
    explicit Loan(int count) : arena(idle_arenas().take(count)) {}
    ~Loan() { idle_arenas().give(std::move(arena)); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
  };
  const Loan loan(thread_count(threads));
  loan.arena->execute([&] { work(); });
}

void apart(FunctionRef<> work) {
  tbb::this_task_arena::isolate([&] { work(); });
}

void for_ranges(std::size_t count, FunctionRef<std::size_t, std::size_t> body) {
  signal();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1), LoopTask(body));
  wait();
}

}  // namespace g3r::parallel
