#include "job.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include <nanobind/stl/string.h>

namespace nb = nanobind;

namespace g3r::python {
namespace {

using namespace std::chrono_literals;

constexpr auto kPause = 20ms;  // between looks at signals: Ctrl-C feels immediate, and the wait costs nothing

struct Shared {
  std::mutex mutex;
  std::condition_variable wake;
  bool done = false;
  std::optional<std::pair<std::string, double>> news;  // the latest progress not yet handed on
  std::exception_ptr failure;
  std::atomic<bool> cancel = false;
};

// False itself, or NumPy's, which comparisons of its numbers give; 0 is none.
bool is_false(const nb::object& answer) {
  const std::string_view type = Py_TYPE(answer.ptr())->tp_name;
  return answer.is(nb::bool_(false)) || ((type == "numpy.bool" || type == "numpy.bool_") && PyObject_IsTrue(answer.ptr()) == 0);
}

// Hands on what there is. Throws what Python raises, and Cancelled when the callable returns False.
void hand_on(const nb::object& progress, std::optional<std::pair<std::string, double>> news) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  if (!news || progress.is_none()) return;
  const nb::object answer = progress(news->first, news->second);
  if (is_false(answer)) throw Cancelled();
}

}  // namespace

void run_job(const nb::object& progress, const std::function<void(const Monitor&)>& work) {
  Shared shared;
  Monitor monitor;
  monitor.cancel = &shared.cancel;
  monitor.progress = [&shared](std::string_view stage, double fraction) {
    const std::lock_guard lock(shared.mutex);
    shared.news.emplace(std::string(stage), fraction);
    return !shared.cancel.load();
  };
  std::thread worker([&] {
    std::exception_ptr failure;
    try {
      work(monitor);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(shared.mutex);
    shared.failure = failure;
    shared.done = true;
    shared.wake.notify_one();
  });

  std::exception_ptr raised;  // by Python
  bool done = false;
  while (!done) {
    std::optional<std::pair<std::string, double>> news;
    {
      const nb::gil_scoped_release release;
      std::unique_lock lock(shared.mutex);
      shared.wake.wait_for(lock, kPause, [&] { return shared.done; });
      done = shared.done;
      news = std::exchange(shared.news, std::nullopt);
    }
    if (raised) continue;
    try {
      hand_on(progress, std::move(news));
    } catch (...) {
      raised = std::current_exception();
      shared.cancel = true;
    }
  }
  {
    const nb::gil_scoped_release release;
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (shared.failure) std::rethrow_exception(shared.failure);
}

}  // namespace g3r::python
