// libFuzzer target for the command line: one argument per line of the input. It is read and completed, and nothing is run.
#include "settings.h"

#include <iostream>
#include <string>
#include <vector>

#include "exit_code.h"
#include "require.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  std::cout.rdbuf(nullptr);  // --help
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const g3r::fuzz::MemoryLaw law(size);
  std::vector<std::string> arguments(1);
  for (std::size_t i = 0; i < size; ++i) {
    if (data[i] == '\n') {
      arguments.emplace_back();
    } else if (data[i] != 0) {  // ends an argument in every program
      arguments.back() += static_cast<char>(data[i]);
    }
  }
  std::vector<const char*> argv = {"g3r"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  try {
    (void)g3r::cli::parse_command_line(static_cast<int>(argv.size()), argv.data());
  } catch (const g3r::cli::UsageError&) {
  }
  return 0;
}
