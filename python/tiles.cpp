#include "tiles.h"

#include <g3r/tiles.h>

#include <string>
#include <vector>

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "job.h"
#include "options.h"

namespace g3r::python {
namespace {

using Text = std::string;

// The members of TileStatus, in order.
nb::tuple give_status(const TileStatus& s) {
  return nb::make_tuple(s.points, s.non_finite, s.tiles, s.done, s.coarse_points, s.largest_tile, s.work, s.worker_memory_bytes,
                        s.disk_bytes, s.converged, s.consistent, s.doubtful, s.open_share, s.undecided_share, s.warnings);
}

nb::tuple plan(const std::vector<Text>& inputs, const Text& folder, const nb::dict& keywords, const nb::object& progress) {
  TileOptions options;
  take(keywords, "max_memory", options.max_memory);
  take(keywords, "tiles", options.tiles);
  take(keywords, "threads", options.threads);
  take(keywords, "device", options.device);
  options.hints = read_hints(keywords);
  TileStatus status;
  run_job(progress, [&](const Monitor& monitor) { status = plan_tiles(inputs, folder, options, monitor); });
  return give_status(status);
}

nb::tuple run(const Text& folder, std::size_t number, std::size_t workers, int threads, const Text& device, const nb::object& progress) {
  const TileWorker worker{number, workers, threads, device};
  TileStatus status;
  run_job(progress, [&](const Monitor& monitor) { status = run_tiles(folder, worker, monitor); });
  return give_status(status);
}

nb::tuple status(const Text& folder) {
  TileStatus status;
  {
    const nb::gil_scoped_release release;
    status = tiles_status(folder);
  }
  return give_status(status);
}

// The members of MergedTiles, in order.
nb::tuple merge(const Text& folder, const Text& output, const nb::object& progress) {
  MergedTiles merged;
  run_job(progress, [&](const Monitor& monitor) { merged = merge_tiles(folder, output, monitor); });
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
