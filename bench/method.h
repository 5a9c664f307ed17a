// A method to be measured: a preset, with single options changed for ablations.
#pragma once

#include <g3r/g3r.h>

#include <string>

namespace g3r::bench {

struct Method {
  std::string name;  ///< as given, for example "paper;epsilon=0.4h;schedule=20 cg"
  Options options;
  MeshOptions mesh;  ///< depth 10 for the paper preset
};

/// PRESET[;KEY=VALUE]... with PRESET default or paper, and KEY one of epsilon (auto, X, X%, Xh, Xn), degree, harmonics, solver
/// (auto, dense, cg), schedule, tolerance, accuracy, depth. Throws InvalidInput.
[[nodiscard]] Method parse_method(const std::string& text);

}  // namespace g3r::bench
