// The g3r program: reads the command line, runs one command, turns errors into exit codes.
#include <g3r/error.h>
#include <g3r/io.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/platform.h"

#include "commands.h"
#include "exit_code.h"
#include "files.h"
#include "interrupts.h"
#include "session.h"
#include "settings.h"
#include "terminal.h"

namespace g3r::cli {
namespace {

int run(const Settings& settings, Session& session) {
  switch (settings.command) {
    case Command::kReconstruct:
      return run_reconstruct(settings, session);
    case Command::kOrient:
      return run_orient(settings, session);
    case Command::kMesh:
      return run_mesh(settings, session);
    case Command::kEval:
      return run_eval(settings, session);
    case Command::kSample:
      return run_sample(settings, session);
    case Command::kInfo:
      return run_info(settings, session);
    case Command::kView:
      return run_view(settings, session);
    case Command::kTiles:
      return run_tiles(settings, session);
  }
  return kBug;
}

int complain(int code, const std::string& what) {
  std::fputs(("g3r: " + escape_text(what) + "\n").c_str(), stderr);
  return code;
}

int exit_code(IoError::Kind kind) {
  switch (kind) {
    case IoError::Kind::kNotFound:
      return kNoInput;
    case IoError::Kind::kCannotCreate:
      return kCannotCreate;
    case IoError::Kind::kFailed:
      return kInputOutput;
  }
  return kInputOutput;
}

// Errors of the solve know nothing of files: the user is told which input they are about.
int complain_of_input(const std::string& input, const std::string& what) {
  const std::string name = escape_text(input == "-" ? "standard input" : input);
  return complain(kBadData, what.find(name) == std::string::npos ? name + ": " + what : what);
}

/// No memory for the stack of another thread. oneTBB reports that as a plain std::runtime_error, with the name of the call that failed.
bool is_lack_of_threads(const std::exception& error) {
  return dynamic_cast<const std::system_error*>(&error) != nullptr ||
         std::string_view(error.what()).find("pthread_create") != std::string_view::npos;
}

int run_program(const std::vector<std::string>& words) {
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::optional<Interrupts> interrupts;
  try {
    interrupts.emplace();
    const std::optional<Settings> settings = parse_command_line(static_cast<int>(argv.size()), argv.data());
    if (!settings) {  // help or version
      if (!std::cout.flush()) throw IoError(IoError::Kind::kFailed, "cannot write to standard output");
      return kOk;
    }
    check_files(*settings);
    Session session(*settings, *interrupts);
    try {
      return run(*settings, session);
    } catch (const InvalidInput& error) {
      return complain_of_input(settings->input, error.what());
    }
  } catch (const UsageError& error) {
    return complain(kUsage, std::string(error.what()) + " (see g3r" + error.command() + " --help)");
  } catch (const InvalidInput& error) {
    return complain(kBadData, error.what());
  } catch (const IoError& error) {
    return complain(exit_code(error.kind()), error.what());
  } catch (const Unavailable& error) {
    return complain(kUnavailable, error.what());
  } catch (const Cancelled&) {
    const int code = interrupts->exit_code();
    return complain(code, code == kTerminated ? "terminated" : "interrupted");
  } catch (const std::bad_alloc&) {
    return complain(kOutOfMemory, "out of memory");
  } catch (const std::exception& error) {
    if (is_lack_of_threads(error)) return complain(kOutOfMemory, "out of memory: cannot start another thread (try --threads 1)");
    return complain(kBug, std::string("an error that should not happen, please report it: ") + error.what());
  }
}

}  // namespace
}  // namespace g3r::cli

int main(int argc, char** argv) {
  g3r::platform::give_back_freed_blocks();
  g3r::cli::prepare_streams();
  return g3r::cli::run_program(g3r::cli::command_line(argc, argv));
}
