// A shared library found at run time.
#pragma once

#include <dlfcn.h>

#include <initializer_list>
#include <utility>

namespace g3r::gpu {

/// The first of some libraries that can be loaded; stays loaded until the end of the process, as drivers do not bear to be unloaded.
class Library {
 public:
  explicit Library(std::initializer_list<const char*> names) {
    for (const char* name : names) {
      handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
      if (handle_ != nullptr) return;
    }
  }
  [[nodiscard]] bool loaded() const { return handle_ != nullptr; }

  /// Looks a function up. False if it is missing.
  template <class Function>
  bool find(const char* name, Function*& function) const {
    function = handle_ == nullptr ? nullptr : reinterpret_cast<Function*>(dlsym(handle_, name));
    return function != nullptr;
  }

 private:
  void* handle_ = nullptr;
};

}  // namespace g3r::gpu
