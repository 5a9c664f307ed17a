# cmake --install, find_package(g3r CONFIG), pkg-config, CPack.
# Two libraries of one compilation: the archive g3r::g3r_static, and g3r::g3r_shared, which is the archive with only the public names
# showing. g3r::g3r is one of them, see g3r-config.cmake.in.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

file(WRITE "${PROJECT_BINARY_DIR}/empty.cpp" "")
add_library(g3r_shared SHARED "${PROJECT_BINARY_DIR}/empty.cpp")
target_link_libraries(g3r_shared PRIVATE $<LINK_LIBRARY:WHOLE_ARCHIVE,g3r>)
target_include_directories(g3r_shared PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(g3r_shared PUBLIC cxx_std_20)
target_link_options(g3r_shared PRIVATE "LINKER:--version-script=${PROJECT_SOURCE_DIR}/src/g3r.map" LINKER:--no-undefined)
set_target_properties(g3r_shared PROPERTIES OUTPUT_NAME g3r VERSION ${PROJECT_VERSION}
                                            SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}  # before 1.0 minor versions differ
                                            LINK_DEPENDS "${PROJECT_SOURCE_DIR}/src/g3r.map")
add_library(g3r::g3r_shared ALIAS g3r_shared)

set_target_properties(g3r PROPERTIES EXPORT_NAME g3r_static)
install(TARGETS g3r EXPORT g3r-static-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(TARGETS g3r_shared EXPORT g3r-shared-targets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT development)
install(DIRECTORY include/g3r DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
if(TARGET g3r_cli)
  install(TARGETS g3r_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
endif()

set(G3R_ARCHIVE_NEEDS ${G3R_THREADING} PNG ZLIB Highway)
list(TRANSFORM G3R_ARCHIVE_NEEDS REPLACE "::.*" "")
if(G3R_WITH_OPEN3D)
  list(APPEND G3R_ARCHIVE_NEEDS Open3D)
endif()
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/g3r)
foreach(kind static shared)
  install(EXPORT g3r-${kind}-targets NAMESPACE g3r:: DESTINATION ${config_dir} COMPONENT development)
endforeach()
configure_package_config_file(cmake/g3r-config.cmake.in g3r-config.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(g3r-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/g3r-config.cmake" "${PROJECT_BINARY_DIR}/g3r-config-version.cmake" cmake/FindHighway.cmake
        DESTINATION ${config_dir} COMPONENT development)
file(RELATIVE_PATH G3R_PC_TO_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")  # the installed tree can be moved
# What the archive needs; named as libraries, as packages required there would be asked of those who link the shared library too.
set(needs ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
list(FILTER needs INCLUDE REGEX "^(std)?c\\+\\+")
list(PREPEND needs png z hwy)
if(G3R_THREADING)
  list(PREPEND needs tbb)
endif()
list(APPEND needs m dl pthread)
list(TRANSFORM needs PREPEND "-l")
list(JOIN needs " " G3R_PC_PRIVATE)
configure_file(cmake/g3r.pc.in g3r.pc @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/g3r.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
g3r_install_licences(${CMAKE_INSTALL_DOCDIR} runtime)
install(FILES README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md SECURITY.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation PATTERN site.css EXCLUDE)
install(CODE "set(G3R_PAGES \"${CMAKE_INSTALL_DOCDIR}\")\nset(G3R_HEADERS \"${CMAKE_INSTALL_INCLUDEDIR}\")" COMPONENT documentation)
install(SCRIPT cmake/InstallPages.cmake COMPONENT documentation)

# What it is made from, as SPDX: of this machine and this moment.
find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  execute_process(COMMAND ${Python3_EXECUTABLE} -B "${PROJECT_SOURCE_DIR}/tools/sbom.py"
                  OUTPUT_FILE "${PROJECT_BINARY_DIR}/g3r.spdx.json" COMMAND_ERROR_IS_FATAL ANY)
  install(FILES "${PROJECT_BINARY_DIR}/g3r.spdx.json" DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
endif()

set(CPACK_PACKAGE_NAME g3r)
set(CPACK_PACKAGE_VENDOR "the g3r authors")
set(CPACK_PACKAGE_CONTACT "the g3r authors <g3r@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development documentation)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY ON)
include(CPack)
