// A shared library found at run time. One source per kind of system: library_posix.cpp, library_windows.cpp, library_none.cpp.
#pragma once

#include <initializer_list>
#include <string>

namespace g3r::gpu {

/// The first of some libraries that can be loaded; stays loaded until the end of the process, as drivers do not bear to be unloaded.
class Library {
 public:
  explicit Library(std::initializer_list<const char*> names);
  [[nodiscard]] bool loaded() const { return handle_ != nullptr; }

  /// Looks a function up. False if it is missing.
  template <class Function>
  bool find(const char* name, Function*& function) const {
    function = reinterpret_cast<Function*>(look_up(name));
    return function != nullptr;
  }
  /// The path of the file that a function is in; empty if it is missing, or the system does not tell.
  [[nodiscard]] std::string file_of(const char* name) const;

 private:
  [[nodiscard]] void* look_up(const char* name) const;
  void* handle_ = nullptr;
};

}  // namespace g3r::gpu
