// The command line and the standard streams as the system hands them over. One source per kind of system: terminal_posix.cpp,
// terminal_windows.cpp.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace g3r::cli {

/// Standard streams that the caller has closed become the null device: an output file must not get their numbers and be written to by
/// accident. On Windows line ends are not translated from here on, and a console shows UTF-8 until the end of the program.
void prepare_streams();

/// The words of the command line, in UTF-8 on Windows.
[[nodiscard]] std::vector<std::string> command_line(int argc, const char* const* argv);

/// Whether standard error is a terminal that can redraw a line.
[[nodiscard]] bool is_capable_terminal();
/// How many characters a line of it has, 0 if it does not tell.
[[nodiscard]] std::size_t terminal_columns();

}  // namespace g3r::cli
