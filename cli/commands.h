// One function per command. Each reads its files, calls the library once and writes the result; it returns the exit code and throws
// what the library throws.
#pragma once

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

}  // namespace g3r::cli
