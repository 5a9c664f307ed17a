// One function per command. Each reads its files, calls the library once and writes the result; it returns the exit code and throws
// what the library throws.
#pragma once

#include <g3r/error.h>

#include <cstddef>
#include <optional>
#include <string>

#include "session.h"
#include "settings.h"

namespace g3r::cli {

int run_reconstruct(const Settings& settings, Session& session);
int run_orient(const Settings& settings, Session& session);
int run_mesh(const Settings& settings, Session& session);
int run_eval(const Settings& settings, Session& session);
int run_sample(const Settings& settings, Session& session);
int run_info(const Settings& settings, Session& session);
int run_view(const Settings& settings, Session& session);
int run_tiles(const Settings& settings, Session& session);

/// What run_orient() does where its plan exceeds --max-memory, or without it three quarters of what is free, and tiles can do the same:
/// nothing is read in core. Empty where it does not, or they cannot (standard input, a part of the input, several outputs or one that is no
/// .ply, options of the method).
[[nodiscard]] std::optional<int> orient_in_tiles(const Settings& settings, Session& session);
/// The same of run_reconstruct(), which has a mesh in the end. Neither can they with options of the mesh.
[[nodiscard]] std::optional<int> reconstruct_in_tiles(const Settings& settings, Session& session);
/// What tiles would need, for the message where a run in core of so many points was refused; "" where the limit allows that, or they
/// cannot be.
[[nodiscard]] std::string what_tiles_need(const Settings& settings, bool mesh, std::size_t points);
/// work(), in core; what it refuses (Unavailable) says what tiles would need.
template <class Work>
auto in_core(const Settings& settings, bool mesh, std::size_t points, const Work& work) {
  try {
    return work();
  } catch (const Unavailable& error) {
    throw Unavailable(error.what() + what_tiles_need(settings, mesh, points));
  }
}

}  // namespace g3r::cli
