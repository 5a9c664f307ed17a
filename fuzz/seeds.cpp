// seeds DIR: writes one small valid file of every format, for the fuzzers to start from.
#include "io_samples.h"

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  for (const g3r::samples::Sample& sample : g3r::samples::all(4))
    g3r::samples::spill(std::string(argv[1]) + "/" + sample.name, sample.bytes);
  return 0;
}
