# Debian's libhwy-dev ships pkg-config files only.
find_package(PkgConfig REQUIRED)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
if(NOT TARGET Highway::hwy)
  add_library(Highway::hwy ALIAS PkgConfig::HWY)
endif()
set(Highway_FOUND TRUE)
