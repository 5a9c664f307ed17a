# The libraries that g3r is made of: the system's, or, where the system lacks one or G3R_BUNDLED is on, compiled here from their sources in
# G3R_SOURCES (tools/sources.sh all), as part of what is linked. The source distribution has these sources.
option(G3R_BUNDLED "Compile all libraries from the sources in G3R_SOURCES, whatever the system has" OFF)

# g3r_bundled(NAME TARGET INCLUDE SOURCE...): the library g3r_NAME, known as TARGET, of sources that are not ours: no warnings, and nothing
# of it is seen from outside of what it is linked into. No source: headers alone.
function(g3r_bundled name target include)
  if(ARGN)
    list(TRANSFORM ARGN PREPEND "${G3R_SOURCES}/${name}/" OUTPUT_VARIABLE sources)
    add_library(g3r_${name} STATIC ${sources})
    set_target_properties(g3r_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden
                                                 VISIBILITY_INLINES_HIDDEN ON CXX_CLANG_TIDY "")
    target_compile_options(g3r_${name} PRIVATE -w)
    target_include_directories(g3r_${name} SYSTEM PUBLIC "${G3R_SOURCES}/${name}/${include}")
  else()
    add_library(g3r_${name} INTERFACE)
    target_include_directories(g3r_${name} SYSTEM INTERFACE "${G3R_SOURCES}/${name}/${include}")
  endif()
  add_library(${target} ALIAS g3r_${name})
endfunction()

function(g3r_build_tbb)
  set(sources address_waiter allocator arena arena_slot concurrent_bounded_queue dynamic_link exception global_control governor itt_notify main
              market misc misc_ex observer_proxy parallel_pipeline private_server profiling queuing_rw_mutex rml_tbb rtm_mutex rtm_rw_mutex
              semaphore small_object_pool task task_dispatcher task_group_context version)
  list(TRANSFORM sources REPLACE "(.+)" "src/tbb/\\1.cpp")
  g3r_bundled(tbb TBB::tbb include ${sources})
  set_target_properties(g3r_tbb PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
  set_source_files_properties("${G3R_SOURCES}/tbb/src/tbb/parallel_pipeline.cpp" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # its names clash
  target_compile_features(g3r_tbb PRIVATE cxx_std_17)
  target_compile_definitions(g3r_tbb PRIVATE __TBB_BUILD __TBB_DYNAMIC_LOAD_ENABLED=0 __TBB_SOURCE_DIRECTLY_INCLUDED=1
                                             $<$<PLATFORM_ID:Darwin>:_XOPEN_SOURCE> $<$<PLATFORM_ID:Darwin>:_DARWIN_C_SOURCE>)
  # Instructions that it asks the processor for before it uses them.
  target_compile_options(g3r_tbb PRIVATE $<$<BOOL:${G3R_X86}>:-mrtm -mwaitpkg> $<$<CXX_COMPILER_ID:GNU>:-flifetime-dse=1>)
  find_package(Threads REQUIRED)
  target_link_libraries(g3r_tbb PUBLIC Threads::Threads)
endfunction()

function(g3r_build_highway)
  g3r_bundled(highway Highway::hwy . hwy/targets.cc)
  target_compile_features(g3r_highway PRIVATE cxx_std_17)
  target_compile_definitions(g3r_highway PUBLIC HWY_STATIC_DEFINE)
endfunction()

function(g3r_build_zlib)
  set(sources adler32 compress crc32 deflate infback inffast inflate inftrees trees uncompr zutil)
  list(TRANSFORM sources APPEND ".c")
  g3r_bundled(zlib ZLIB::ZLIB . ${sources})
  target_compile_definitions(g3r_zlib PRIVATE $<$<PLATFORM_ID:Darwin>:fdopen=fdopen>)  # zutil.h takes it away from old systems of that maker
endfunction()

function(g3r_build_png)
  set(sources png pngerror pngget pngmem pngpread pngread pngrio pngrtran pngrutil pngset pngtrans pngwio pngwrite pngwtran pngwutil)
  list(TRANSFORM sources APPEND ".c")
  g3r_bundled(png PNG::PNG . ${sources})
  configure_file("${G3R_SOURCES}/png/scripts/pnglibconf.h.prebuilt" "${PROJECT_BINARY_DIR}/png/pnglibconf.h" COPYONLY)
  target_include_directories(g3r_png SYSTEM PUBLIC "${PROJECT_BINARY_DIR}/png")
  target_compile_definitions(g3r_png PRIVATE PNG_ARM_NEON_OPT=0)
  target_compile_options(g3r_png PRIVATE $<$<PLATFORM_ID:Darwin>:SHELL:-include math.h>)  # pngpriv.h asks for fp.h there, unless it has it
  target_link_libraries(g3r_png PUBLIC ZLIB::ZLIB)
endfunction()

function(g3r_build_eigen)
  g3r_bundled(eigen Eigen3::Eigen .)
endfunction()

function(g3r_build_json)
  g3r_bundled(json nlohmann_json::nlohmann_json .)
endfunction()

# g3r_library(PACKAGE TARGET FOLDER OPTION...): TARGET, from find_package(PACKAGE OPTION...) or from the sources in FOLDER.
set(G3R_BUNDLED_LIBRARIES "")
macro(g3r_library package target folder)
  if(NOT G3R_BUNDLED)
    find_package(${package} ${ARGN} QUIET)
  endif()
  if(NOT TARGET ${target})
    if(G3R_FETCH_SOURCES AND NOT EXISTS "${G3R_SOURCES}/${folder}/checksum")
      execute_process(COMMAND bash "${PROJECT_SOURCE_DIR}/tools/sources.sh" all RESULT_VARIABLE ignored)
    endif()
    if(NOT EXISTS "${G3R_SOURCES}/${folder}/checksum")
      message(FATAL_ERROR "g3r: ${package} was not found, and there are no sources of it in ${G3R_SOURCES}/${folder}: "
                          "install its development package (packages.txt), or run tools/sources.sh all")
    endif()
    enable_language(C)
    cmake_language(CALL g3r_build_${folder})
    list(APPEND G3R_BUNDLED_LIBRARIES ${folder})
  endif()
endmacro()

string(REGEX MATCH "^(x86_64|AMD64|i[3-6]86)$" G3R_X86 "${CMAKE_SYSTEM_PROCESSOR}")
# What cpu/parallel.h runs loops on; empty: the calling thread.
set(G3R_THREADING "")
if(G3R_THREADS)
  g3r_library(TBB TBB::tbb tbb)
  set(G3R_THREADING TBB::tbb)
endif()
if(NOT G3R_BUNDLED)
  find_package(Eigen3 5 NO_MODULE QUIET)  # its version file takes no other first number than its own: 3.4 was followed by 5
endif()
g3r_library(Eigen3 Eigen3::Eigen eigen 3.4 NO_MODULE)
g3r_library(nlohmann_json nlohmann_json::nlohmann_json json)
g3r_library(Highway Highway::hwy highway)
g3r_library(ZLIB ZLIB::ZLIB zlib)
g3r_library(PNG PNG::PNG png)
if(G3R_INSTALL AND G3R_BUNDLED_LIBRARIES)
  message(FATAL_ERROR "g3r: the install rules need the system's ${G3R_BUNDLED_LIBRARIES}: install them, or add -DG3R_INSTALL=OFF")
endif()
