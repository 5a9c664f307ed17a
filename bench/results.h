// The rows of a run as JSON (everything) and as markdown (what a reader wants to see).
//
// The JSON: `schema` 1; `version`, `label`, `seed`, `threads` (0: all), `poisson_available`; `rows`: one object per measurement with
// `model`, `input`, `points`, `method`, and either `error` or
//   - `ae_p`, `pco` (both 0..1), `angle_degrees` (quantiles 50, 90, 95, 99 percent), `confidence_auc` (absent when all points are on one
//     side), `right_and_sure`, `wrong_and_sure` (shares of all points, with a confidence above 0.9), `outlier_confidence` (absent without
//     outliers);
//   - `thin`, `wrong_thin`: shares of all points, and of the wrong ones, that lie so near another side; the second absent when all are
//   right;
//   - `seconds` (wall clock without the mesh), `cpu_seconds` (of all threads: compare that where the machine is shared), and what orient()
//     reports; `peak_memory_bytes` is that of the whole process so far;
//   - with --mesh, `mesh` with `cd`, `ae_m`, `hd`, the counts and checks of check_mesh(), `self_intersections`, `seconds` and `cpu_seconds`
//     of the mesher, or a text `mesh_error`.
#pragma once

#include <string>
#include <vector>

#include "measure.h"

namespace g3r::bench {

/// What a run was asked to do.
struct RunInfo {
  std::string label;  ///< free text, for example the commit
  std::uint64_t seed = 0;
  int threads = 0;
};

[[nodiscard]] std::string to_json(const RunInfo& run, const std::vector<Row>& rows);
[[nodiscard]] std::string to_markdown(const RunInfo& run, const std::vector<Row>& rows);

}  // namespace g3r::bench
