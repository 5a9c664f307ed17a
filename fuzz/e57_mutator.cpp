// What changes E57 files for the fuzzer: their pages without the checksums, which are made anew, for else nothing but them is tested.
#include <cstdint>

#include "e57_samples.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned /*seed*/) {
  using namespace g3r::samples;
  std::string logical = without_checksums({reinterpret_cast<const char*>(data), size});
  size = logical.size();
  logical.resize(max_size / kE57Page * kE57Payload);
  if (logical.empty()) return 0;
  logical.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(logical.data()), std::min(size, logical.size()), logical.size()));
  const std::string bytes = with_checksums(logical);
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}
