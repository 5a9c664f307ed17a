# g3r_embed_text(TARGET SOURCE NAMESPACE FILE...): makes SOURCE in the build folder, one `extern const std::string_view` per text
# file, named after the file (page.html -> page_html), and adds it to the target.
function(g3r_embed_text target source namespace)
  set(output "${CMAKE_CURRENT_BINARY_DIR}/${source}")
  list(TRANSFORM ARGN PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" OUTPUT_VARIABLE inputs)
  string(REPLACE ";" "|" joined "${inputs}")
  set(script "${PROJECT_SOURCE_DIR}/cmake/EmbedTextScript.cmake")
  add_custom_command(
    OUTPUT "${output}"
    COMMAND "${CMAKE_COMMAND}" "-DOUTPUT=${output}" "-DNAMESPACE=${namespace}" "-DINPUTS=${joined}" -P "${script}"
    DEPENDS ${inputs} "${script}"
    VERBATIM)
  target_sources(${target} PRIVATE "${output}")
  # The target may live in another directory, where neither the rule nor the property would be seen.
  string(MAKE_C_IDENTIFIER "${target}_${source}" rule)
  add_custom_target(${rule} DEPENDS "${output}")
  add_dependencies(${target} ${rule})
  set_source_files_properties("${output}" TARGET_DIRECTORY ${target} PROPERTIES GENERATED TRUE)
endfunction()
