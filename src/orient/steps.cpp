#include "orient/steps.h"

#include <g3r/error.h>

#include <algorithm>
#include <string>

namespace g3r {

StepSet parse_steps(std::string_view names) {
  StepSet steps;
  while (!names.empty()) {
    const std::size_t comma = std::min(names.find(','), names.size());
    const std::string_view name = names.substr(0, comma);
    const auto* const found = std::find(kStepNames.begin(), kStepNames.end(), name);
    if (found == kStepNames.end()) {
      std::string known;
      for (const std::string_view step : kStepNames) known += (known.empty() ? "" : ", ") + std::string(step);
      throw InvalidInput("step '" + std::string(name) + "' is none of " + known);
    }
    steps.set(static_cast<std::size_t>(found - kStepNames.begin()));
    names.remove_prefix(std::min(comma + 1, names.size()));
  }
  return steps;
}

}  // namespace g3r
