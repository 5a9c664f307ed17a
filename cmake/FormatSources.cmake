# The sources of LASzip and libE57Format, which Debian 12 has no packages of, in G3R_SOURCES (tools/sources.sh puts them there). Sets
# G3R_LASZIP and G3R_E57 to their folders, empty where a format is left out.
set(G3R_SOURCES "${PROJECT_SOURCE_DIR}/build/sources" CACHE PATH "Folder with the sources of LASzip (laszip) and libE57Format (e57)")
option(G3R_WITH_LAZ "Read and write LAZ, if the sources of LASzip are there" ON)
option(G3R_WITH_E57 "Read E57, if the sources of libE57Format are there" ON)
option(G3R_FETCH_SOURCES "Run tools/sources.sh if a source is missing (for builds of the Python package)" OFF)

set(G3R_LASZIP "")
set(G3R_E57 "")
if(G3R_FETCH_SOURCES AND NOT (EXISTS "${G3R_SOURCES}/laszip/src" AND EXISTS "${G3R_SOURCES}/e57/src"))
  execute_process(COMMAND bash "${PROJECT_SOURCE_DIR}/tools/sources.sh" RESULT_VARIABLE ignored)  # it says what is missing
endif()
if(G3R_WITH_LAZ AND EXISTS "${G3R_SOURCES}/laszip/src/laswritepoint.cpp")
  set(G3R_LASZIP "${G3R_SOURCES}/laszip")
elseif(G3R_WITH_LAZ)
  message(NOTICE "g3r: LAZ is left out: no LASzip in ${G3R_SOURCES}/laszip (tools/sources.sh fetches it)")
endif()
if(G3R_WITH_E57 AND EXISTS "${G3R_SOURCES}/e57/src/CompressedVectorReaderImpl.cpp")
  set(G3R_E57 "${G3R_SOURCES}/e57")
elseif(G3R_WITH_E57)
  message(NOTICE "g3r: E57 is left out: no libE57Format in ${G3R_SOURCES}/e57 (tools/sources.sh fetches it)")
endif()

# g3r_install_licences(FOLDER COMPONENT): the licences of the libraries that are part of g3r.
function(g3r_install_licences folder component)
  if(G3R_LASZIP)
    install(FILES "${G3R_LASZIP}/COPYING.txt" DESTINATION ${folder} COMPONENT ${component} RENAME LICENSE.LASzip)
  endif()
  if(G3R_E57)
    install(FILES "${G3R_E57}/LICENSE.md" DESTINATION ${folder} COMPONENT ${component} RENAME LICENSE.libE57Format)
    install(FILES "${G3R_E57}/LICENSE-MIT.md" DESTINATION ${folder} COMPONENT ${component} RENAME LICENSE.libE57Format-MIT)
    install(FILES "${G3R_E57}/extern/CRCpp/LICENSE" DESTINATION ${folder} COMPONENT ${component} RENAME LICENSE.CRCpp)
  endif()
endfunction()
