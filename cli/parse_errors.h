// What is wrong with a command line, in words of this program rather than of its parser.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace g3r::cli {

/// What was wrong, what was expected, what to do. `app` has parsed the command line and thrown `error`.
[[nodiscard]] std::string about_parse_error(const CLI::App& app, const CLI::ParseError& error);

/// The command that a command line names, " tiles plan", or "" for none.
[[nodiscard]] std::string named_command(const CLI::App& app);

}  // namespace g3r::cli
