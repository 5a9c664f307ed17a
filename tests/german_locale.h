// A locale that writes 1,5 for one and a half, for what must not depend on it.
#pragma once

#include <clocale>
#include <cstdlib>
#include <string>

#include "temporary_folder.h"

namespace g3r {

/// That of C's functions in all of the program to the end of the scope, where the machine has it or what makes it. Debian has locales as
/// sources only (package locales).
class GermanLocale {
 public:
  GermanLocale() {
    (void)std::system(("localedef -i de_DE -f UTF-8 " + folder_.file("de_DE.UTF-8") + " 2> /dev/null").c_str());
    setenv("LOCPATH", folder_.file("").c_str(), 1);
    is_there_ = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
    unsetenv("LOCPATH");
  }
  ~GermanLocale() { std::setlocale(LC_ALL, before_.c_str()); }
  GermanLocale(const GermanLocale&) = delete;
  GermanLocale& operator=(const GermanLocale&) = delete;

  [[nodiscard]] bool is_there() const { return is_there_; }

 private:
  TemporaryFolder folder_;
  std::string before_ = std::setlocale(LC_ALL, nullptr);
  bool is_there_ = false;
};

inline constexpr const char* kNoGermanLocale = "no German locale on this machine (package locales)";

}  // namespace g3r
