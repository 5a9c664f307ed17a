// The rows of a run as JSON (everything) and as markdown (what a reader wants to see). README.md describes both.
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
