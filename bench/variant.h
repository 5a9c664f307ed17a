// A method to be measured: a preset, with single options changed for ablations.
#pragma once

#include <g3r/g3r.h>

#include <string>

namespace g3r::bench {

struct Variant {
  std::string name;           ///< as given, for example "paper;epsilon=0.4h;schedule=20 cg"
  bool true_normals = false;  ///< nothing is oriented: only the mesher is measured, from the normals of the truth
  bool ceiling = false;       ///< nothing is oriented: the normals are ceiling_normals(), which know the true surface
  Options options;
  MeshOptions mesh;
};

/// NAME[;KEY=VALUE]... with NAME a preset (default, paper), an earlier method (wnnc, agr, pgr), `true` or `ceiling`, and KEY one of method
/// (green, energy, wnnc, agr, pgr), widths (of wnnc), epsilon and noise (auto, X, X%, Xh, Xn), degree, harmonics, solver (auto, dense, cg),
/// schedule, without (steps, docs/evidence/steps.md), tolerance, accuracy, mesher (field, poisson), depth. Throws InvalidInput.
[[nodiscard]] Variant parse_variant(const std::string& text);

}  // namespace g3r::bench
