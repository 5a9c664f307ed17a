# A header: found by its name, so that no config file of a packager is needed.
find_path(NANOFLANN_INCLUDE_DIR nanoflann.hpp)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Nanoflann REQUIRED_VARS NANOFLANN_INCLUDE_DIR)
if(Nanoflann_FOUND AND NOT TARGET Nanoflann::nanoflann)
  add_library(Nanoflann::nanoflann INTERFACE IMPORTED)
  set_target_properties(Nanoflann::nanoflann PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${NANOFLANN_INCLUDE_DIR}")
endif()
