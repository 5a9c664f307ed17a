// What an argument that nothing takes could have been meant for.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace g3r::cli {

/// The first argument that nothing takes, and what could have been meant. `app` has parsed a command line with such arguments.
[[nodiscard]] std::string about_extras(const CLI::App& app);

}  // namespace g3r::cli
