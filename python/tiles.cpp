#include "tiles.h"

#include <g3r/tiles.h>

#include <string>
#include <vector>

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "job.h"
#include "options.h"
#include "text.h"

namespace g3r::python {
namespace {

using Text = std::string;

// The members of TileStatus, in order.
nb::tuple give_status(const TileStatus& s) {
  return nb::make_tuple(s.points, s.non_finite, s.tiles, s.done, s.coarse_points, s.largest_tile, s.work, s.worker_memory_bytes,
                        s.disk_bytes, s.converged, s.consistent, s.doubtful, s.open_share, s.undecided_share, printable(s.warnings));
}

nb::tuple plan(const std::vector<nb::bytes>& inputs, const nb::bytes& folder, const nb::dict& keywords, const nb::object& progress) {
  TileOptions options;
  take(keywords, "max_memory", options.max_memory);
  take(keywords, "tiles", options.tiles);
  take(keywords, "threads", options.threads);
  take(keywords, "device", options.device);
  options.hints = read_hints(keywords);
  std::vector<Text> names;
  for (const nb::bytes& input : inputs) names.push_back(name_of(input));
  const Text work = name_of(folder);
  TileStatus status;
  run_job(progress, [&](const Monitor& monitor) { status = plan_tiles(names, work, options, monitor); });
  return give_status(status);
}

nb::tuple run(const nb::bytes& folder, std::size_t number, std::size_t workers, int threads, const Text& device,
              const nb::object& progress) {
  const Text work = name_of(folder);
  const TileWorker worker{number, workers, threads, device};
  TileStatus status;
  run_job(progress, [&](const Monitor& monitor) { status = run_tiles(work, worker, monitor); });
  return give_status(status);
}

nb::tuple status(const nb::bytes& folder) {
  const Text work = name_of(folder);
  TileStatus status;
  {
    const nb::gil_scoped_release release;
    status = tiles_status(work);
  }
  return give_status(status);
}

// The members of MergedTiles, in order.
nb::tuple merge(const nb::bytes& folder, const nb::bytes& output, const nb::object& progress) {
  const Text work = name_of(folder);
  const Text result = name_of(output);
  MergedTiles merged;
  run_job(progress, [&](const Monitor& monitor) { merged = merge_tiles(work, result, monitor); });
  warn_caller(merged.warnings);
  return nb::make_tuple(merged.confidence_mean, merged.confidence_below_half);
}

}  // namespace

void bind_tiles(nb::module_& m) {
  m.def("tiles_plan", &plan, nb::arg("inputs"), nb::arg("folder"), nb::arg("options"), nb::arg("progress").none());
  m.def("tiles_run", &run, nb::arg("folder"), nb::arg("number"), nb::arg("workers"), nb::arg("threads"), nb::arg("device"),
        nb::arg("progress").none());
  m.def("tiles_status", &status, nb::arg("folder"));
  m.def("tiles_merge", &merge, nb::arg("folder"), nb::arg("output"), nb::arg("progress").none());
}

}  // namespace g3r::python
