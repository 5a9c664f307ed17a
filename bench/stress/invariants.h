// What must hold for every cloud.
//
//   crash       the run ends by itself, within its time and the memory of the child that it runs in (run_apart.h)
//   refused     no error but for clouds that are none: fewer than 4 distinct places, all on a line, no surface or one below one triangle
//   number      normals are unit and finite, areas finite and not negative, confidence is in [0, 1], of vertices too, the
//               report is finite
//   memory      the peak stays within the plan
//   mesh        closed and manifold unless trimmed, every coordinate finite
//   weld        closed after vertices at the same place are made one: every edge has as many triangles one way as the other
//   threads     the same bytes for one and two threads
//   order       the same bytes for the points in another order
//   program     the same normals and confidence from the command line
//   rigid       points that are sure of their side keep it when the cloud is turned, unless rounding moves them then (statistical)
//   confidence  few points are wrong and sure, or there is a warning (statistical)
//   thin        the same, where most of the wrong ones have another side of the surface so near that the samples do not tell (statistical)
#pragma once

#include <g3r/g3r.h>
#include <g3r/io.h>

#include <cstddef>
#include <string>
#include <vector>

#include "scene.h"

namespace g3r::stress {

struct Finding {
  std::string kind;
  std::string what;
};

struct Outcome {
  std::vector<Finding> findings;
  double cpu_seconds = 0;  ///< of one run; 0 if it was refused
  bool refused = false;    ///< rightly
  bool warned = false;     ///< of sides
  double wrong = 0;        ///< share of the points whose truth is known
  double wrong_and_sure = 0;
  bool touches = false;  ///< the mesh touches itself: it is not manifold once vertices at the same place are made one
};

struct Demands {
  std::string program;  ///< path of the g3r program, empty: not run
  bool statistical = true;
  std::size_t thorough_points = 20000;  ///< clouds of more points get one of the repeated runs instead of all
};

/// Whether a kind of finding is a matter of shares, which a redesign of the method moves; all others are absolute.
[[nodiscard]] bool is_statistical(const std::string& kind);

/// Holds one result of the case to what has to be true of it by itself: number, mesh, weld and, if wanted, confidence and thin.
[[nodiscard]] Outcome hold_result(const Case& tested, const Reconstruction& result, bool statistical);

/// What is not the same in the file that the program has written; empty if all is.
[[nodiscard]] std::string difference_in_file(const Cloud& written, const Orientation& result);

/// Runs the case, up to five times, in this process.
[[nodiscard]] Outcome hold(const Case& tested, const Demands& demands);

}  // namespace g3r::stress
