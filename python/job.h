// Long work for Python: without the interpreter lock, with progress, and with a Ctrl-C that is heard.
#pragma once

#include <g3r/g3r.h>

#include <functional>

#include <nanobind/nanobind.h>

namespace g3r::python {

/// Runs `work` on its own thread and waits for it with the interpreter lock released. Meanwhile the calling thread hands progress on to
/// `progress` (None, or a callable (stage, fraction) that cancels by returning False) and lets Python see signals.
/// Whatever Python raises there cancels the work and is raised again; what the work throws is thrown here.
void run_job(const nanobind::object& progress, const std::function<void(const Monitor&)>& work);

}  // namespace g3r::python
