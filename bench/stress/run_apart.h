// A case in a process of its own: crashes, hangs and lack of memory are findings like any other.
#pragma once

#include "invariants.h"

namespace g3r::stress {

struct Limits {
  unsigned cpu_seconds = 600;              ///< of all runs of a case together
  std::size_t address_bytes = 8ULL << 30;  ///< not under sanitizers
  unsigned wall_seconds = 6000;            ///< for what waits for ever: the processor is busy with others for most of them at worst
};

/// Forks, so the calling process must not have started threads. Throws IoError if there can be no further process.
[[nodiscard]] Outcome hold_apart(const Case& tested, const Demands& demands, const Limits& limits = {});

/// The same for a recipe, whose scene is made in the other process as well.
[[nodiscard]] Outcome hold_apart(const Recipe& recipe, const Demands& demands, const Limits& limits = {});

}  // namespace g3r::stress
