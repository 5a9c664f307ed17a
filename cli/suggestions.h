// What an argument that nothing takes could have been meant for.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace g3r::cli {

/// "; did you mean WORD?" if one of the words is near, or begins so, else nothing.
[[nodiscard]] std::string suggestion(const std::string& found, const std::vector<std::string>& words);

/// The command that the command line names: of g3r tiles plan the second.
[[nodiscard]] const CLI::App& deepest_command(const CLI::App& app);

/// The first argument that nothing takes, and what could have been meant. `app` has parsed a command line with such arguments.
[[nodiscard]] std::string about_extras(const CLI::App& app);

}  // namespace g3r::cli
