# Installs the package into a scratch folder, builds the consumer against it in every way and runs its tests:
# cmake -DBUILD=... -DSOURCE=... -P run.cmake
set(prefix "${BUILD}/consumer/prefix")
file(REMOVE_RECURSE "${BUILD}/consumer")
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()
foreach(component runtime development)
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} --component ${component})
endforeach()
file(GLOB pc "${prefix}/lib*/pkgconfig" "${prefix}/lib/*/pkgconfig")
file(GLOB library "${prefix}/lib*/libg3r.so" "${prefix}/lib/*/libg3r.so")
get_filename_component(library_dir "${library}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${pc}")
set(ENV{LD_LIBRARY_PATH} "${library_dir}")

# With the archive; and with the shared library, which must do without the libraries that the archive needs.
set(static_options -DEXPECTED=STATIC)
set(shared_options -DEXPECTED=SHARED -DBUILD_SHARED_LIBS=ON)
set(no_archive_options -DEXPECTED=SHARED -DCMAKE_DISABLE_FIND_PACKAGE_PNG=ON)
foreach(kind static shared no_archive)
  set(build "${BUILD}/consumer/${kind}")
  run(${CMAKE_COMMAND} -S ${SOURCE} -B ${build} -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_CXX_COMPILER=${CXX} ${${kind}_options})
endforeach()
foreach(kind static shared)
  run(${CMAKE_COMMAND} --build ${BUILD}/consumer/${kind})
  run(${CMAKE_CTEST_COMMAND} --test-dir ${BUILD}/consumer/${kind} --output-on-failure --no-tests=error)
endforeach()

# A component that there is not is named.
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/unknown -B ${BUILD}/consumer/unknown -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${prefix}
                RESULT_VARIABLE result ERROR_VARIABLE text OUTPUT_QUIET)
string(REGEX REPLACE "[ \n]+" " " text "${text}")
if(result EQUAL 0 OR NOT text MATCHES "g3r has no component headers: there are static and shared")
  message(FATAL_ERROR "an unknown component is not named: ${text}")
endif()

# Within another project g3r is the library alone: nothing that only the program needs is asked for.
run(${CMAKE_COMMAND} -S ${SOURCE}/parent -B ${BUILD}/consumer/parent -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON)

# What is copied from a build without install rules goes with its licences.
run(${CMAKE_COMMAND} -S ${SOURCE}/../.. -B ${BUILD}/consumer/copied -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${CXX}
    -DG3R_INSTALL=OFF -DG3R_BUILD_CLI=OFF -DG3R_BUILD_TESTS=OFF -DG3R_BUILD_BENCH=OFF -DG3R_BUILD_EXAMPLES=OFF)
run(${CMAKE_COMMAND} --install ${BUILD}/consumer/copied --component licences --prefix ${BUILD}/consumer/copied/prefix)
if(NOT EXISTS "${BUILD}/consumer/copied/prefix/share/doc/g3r/LICENSE")
  message(FATAL_ERROR "no licence goes with a program that is copied")
endif()

# The shared library shows the public names and no other.
execute_process(COMMAND nm -D --defined-only -C ${library} OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+\n" names "${names}")
foreach(name IN LISTS names)
  if(NOT name MATCHES " [A-Za-z] (g3r::|g3r_|G3R_0|typeinfo (name )?for g3r::|vtable for g3r::)")
    message(SEND_ERROR "the shared library shows ${name}")
  endif()
endforeach()
