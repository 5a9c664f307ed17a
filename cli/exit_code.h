// The exit codes of the program (those of sysexits.h where it has one), and the error that stands for a wrong command line.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace g3r::cli {

enum ExitCode : int {
  kOk = 0,
  kUsage = 64,         ///< the command line is wrong
  kBadData = 65,       ///< the input cannot be used; with --strict also: the result is doubtful
  kNoInput = 66,       ///< an input does not exist or may not be read
  kUnavailable = 69,   ///< not possible with this build or within --max-memory
  kBug = 70,           ///< an error in g3r itself
  kOutOfMemory = 71,   ///< the system gave no more memory
  kCannotCreate = 73,  ///< the output cannot be created, or is an input
  kInputOutput = 74,   ///< reading or writing broke off
  kInterrupted = 130,  ///< Ctrl-C
  kTerminated = 143    ///< SIGTERM
};

/// The list above for --help.
inline constexpr const char* kExitCodeHelp =
    "Exit codes: 0 done, 64 wrong command line, 65 bad data (with --strict also a\n"
    "doubtful result), 66 no input, 69 not possible with this build or within\n"
    "--max-memory, 70 a bug in g3r, 71 out of memory, 73 cannot create the output,\n"
    "74 input/output error, 130 interrupted, 143 terminated.\n";

/// The command line asks for something that cannot be; ends the program with kUsage.
class UsageError : public std::runtime_error {
 public:
  /// `command`: the one whose help has more, with a blank before it, or "".
  explicit UsageError(const std::string& what, std::string command = "") : std::runtime_error(what), command_(std::move(command)) {}
  [[nodiscard]] const std::string& command() const { return command_; }

 private:
  std::string command_;
};

}  // namespace g3r::cli
