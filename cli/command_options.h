// What stands on the command line after each command.
#pragma once

#include <CLI/CLI.hpp>

#include "settings.h"

namespace g3r::cli {

/// Adds the arguments of g3r itself and all commands, which write into the settings.
void add_commands(CLI::App& app, Settings& settings);

}  // namespace g3r::cli
