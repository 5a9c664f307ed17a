# g3r_target_defaults(TARGET): the settings that every target of this project shares.
function(g3r_target_defaults target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  # -ffp-contract=off: the same bytes whatever instructions the compiler may use.
  target_compile_options(${target} PRIVATE "$<IF:$<BOOL:${G3R_WARNINGS}>,-Wall;-Wextra;-Wconversion,-w>" -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms of GCC 12 about strings that are added up (its bugs 105329 and 105651), more of them with precompiled headers.
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
  if(G3R_TOGETHER AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)  # sources that another includes look like headers
    # GCC collects garbage from 1 GiB on, not from 256 MiB, half of which are the precompiled headers.
    target_compile_options(${target} PRIVATE "SHELL:--param ggc-min-heapsize=524288")
  endif()
  if(G3R_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(G3R_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${G3R_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${G3R_SANITIZE})
  endif()
endfunction()

# g3r_precompile(TARGET HEADER...): headers of other libraries that many sources of the target include, parsed once for all. Never our own,
# of which a change would compile everything anew. What a source needs it includes all the same: without G3R_PRECOMPILE it has no others.
function(g3r_precompile target)
  if(G3R_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()
set(G3R_STANDARD_HEADERS <algorithm> <array> <atomic> <charconv> <cmath> <cstdint> <cstdio> <cstring> <filesystem> <functional> <limits> <map>
                         <memory> <mutex> <numbers> <numeric> <optional> <set> <span> <sstream> <string> <string_view> <system_error> <tuple>
                         <unordered_map> <utility> <vector>)

# g3r_laszip_defaults(TARGET): settings for sources of LASzip, which are not ours: no warnings, and no UBSan, which stops at its unaligned
# loads and shifts.
function(g3r_laszip_defaults target)
  target_compile_features(${target} PRIVATE cxx_std_17)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                             CXX_CLANG_TIDY "")
  target_include_directories(${target} PRIVATE "${G3R_LASZIP}/src" "${G3R_LASZIP}/include/laszip")
  target_compile_definitions(${target} PRIVATE UNORDERED HAVE_UNORDERED_MAP=1)
  target_compile_options(${target} PRIVATE -w)
  if(G3R_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${G3R_SANITIZE} -fno-sanitize=undefined -fno-omit-frame-pointer)
  endif()
endfunction()

# g3r_libe57_defaults(TARGET): the same for sources of libE57Format, but that only the width of its widest integers overflows (rightly). It
# expects a header that its own build makes, and those of Xerces-C++, of which src/io/e57_xml.h has what it uses. Its messages name files of
# its sources: without the folder, so that builds in any folder are the same bytes (tools/reproducible.sh).
function(g3r_libe57_defaults target)
  file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/e57/E57Export.h" CONTENT "#define E57_DLL\n")
  foreach(header sax/InputSource sax2/Attributes sax2/DefaultHandler sax2/XMLReaderFactory util/BinInputStream util/TransService)
    file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/e57/xercesc/${header}.hpp" CONTENT "#include \"io/e57_xml.h\"\n")
  endforeach()
  target_compile_features(${target} PRIVATE cxx_std_17)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                             CXX_CLANG_TIDY "")
  target_include_directories(${target} PRIVATE "${G3R_E57}/include" "${G3R_E57}/src" "${G3R_E57}/extern/CRCpp/inc"
                                               "${PROJECT_SOURCE_DIR}/src"
                                               "${PROJECT_BINARY_DIR}/e57")
  target_compile_definitions(${target} PRIVATE E57_VALIDATION_LEVEL=1 CRCPP_USE_CPP11 CRCPP_BRANCHLESS REVISION_ID="libE57Format"
                                               __FILE__=__FILE_NAME__)
  target_compile_options(${target} PRIVATE -w)
  if(G3R_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${G3R_SANITIZE} -fno-sanitize=signed-integer-overflow
                                             -fno-omit-frame-pointer -fno-sanitize-recover=all)
  endif()
endfunction()
