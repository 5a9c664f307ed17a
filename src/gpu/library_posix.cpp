#include "gpu/library.h"

#include <dlfcn.h>

namespace g3r::gpu {

Library::Library(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (handle_ != nullptr) return;
  }
}

void* Library::look_up(const char* name) const { return handle_ == nullptr ? nullptr : dlsym(handle_, name); }

std::string Library::file_of(const char* name) const {
  void* const function = look_up(name);
  Dl_info info{};
  return function != nullptr && dladdr(function, &info) != 0 && info.dli_fname != nullptr ? info.dli_fname : "";
}

}  // namespace g3r::gpu
