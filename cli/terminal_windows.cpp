#include "base/platform.h"

// clang-format off
#include <windows.h>  // before the others, which need it
#include <fcntl.h>
#include <io.h>
#include <shellapi.h>
// clang-format on

#include <cstdlib>

#include "terminal.h"

namespace g3r::cli {
namespace {

UINT code_page_before = 0;

HANDLE standard_error() { return GetStdHandle(STD_ERROR_HANDLE); }

}  // namespace

void prepare_streams() {
  for (const int stream : {0, 1, 2}) {
    if (_get_osfhandle(stream) < 0) (void)_open("NUL", _O_RDWR);  // takes the lowest free number, which is this one
    _setmode(stream, _O_BINARY);
  }
  code_page_before = GetConsoleOutputCP();
  if (code_page_before == 0 || code_page_before == CP_UTF8) return;  // no console, or nothing to do
  SetConsoleOutputCP(CP_UTF8);
  (void)std::atexit([] { SetConsoleOutputCP(code_page_before); });
}

std::vector<std::string> command_line(int argc, const char* const* argv) {
  int count = 0;
  wchar_t** const words = CommandLineToArgvW(GetCommandLineW(), &count);
  if (words == nullptr) return {argv, argv + argc};
  std::vector<std::string> line;
  for (int i = 0; i < count; ++i) line.push_back(platform::name_of(words[i]));
  LocalFree(static_cast<void*>(words));
  return line;
}

bool is_capable_terminal() {
  DWORD mode = 0;
  return GetConsoleMode(standard_error(), &mode) != 0 &&
         SetConsoleMode(standard_error(), mode | ENABLE_PROCESSED_OUTPUT | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

std::size_t terminal_columns() {
  CONSOLE_SCREEN_BUFFER_INFO screen{};
  if (GetConsoleScreenBufferInfo(standard_error(), &screen) == 0) return 0;
  return static_cast<std::size_t>(screen.srWindow.Right - screen.srWindow.Left + 1);
}

}  // namespace g3r::cli
