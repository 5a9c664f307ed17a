// For systems where nothing is loaded at run time (browsers): no library is found.
#include "gpu/library.h"

namespace g3r::gpu {

Library::Library(std::initializer_list<const char*> /*names*/) {}

void* Library::look_up(const char* /*name*/) const { return nullptr; }

std::string Library::file_of(const char* /*name*/) const { return {}; }

}  // namespace g3r::gpu
