#include <cstdlib>
#include <string_view>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "terminal.h"

namespace g3r::cli {

void prepare_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) < 0) (void)open("/dev/null", O_RDWR);  // takes the lowest free number, which is this one
  }
}

std::vector<std::string> command_line(int argc, const char* const* argv) { return {argv, argv + argc}; }

bool is_capable_terminal() {
  const char* term = std::getenv("TERM");  // NOLINT(concurrency-mt-unsafe): no thread changes the environment
  return isatty(STDERR_FILENO) != 0 && term != nullptr && std::string_view(term) != "dumb";
}

std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace g3r::cli
