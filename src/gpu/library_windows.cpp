#include "gpu/library.h"

#include <windows.h>

namespace g3r::gpu {

Library::Library(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    handle_ = LoadLibraryExA(name, nullptr, LOAD_LIBRARY_SEARCH_DEFAULT_DIRS);  // not the working directory, which others may write to
    if (handle_ != nullptr) return;
  }
}

void* Library::look_up(const char* name) const {
  return handle_ == nullptr ? nullptr : reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(handle_), name));
}

std::string Library::file_of(const char* /*name*/) const { return {}; }

}  // namespace g3r::gpu
