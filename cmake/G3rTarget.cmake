# g3r_target_defaults(TARGET): the settings that every target of this project shares.
function(g3r_target_defaults target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  # -ffp-contract=off: the same bytes whatever instructions the compiler may use.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -ffp-contract=off)
  if(G3R_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(G3R_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${G3R_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${G3R_SANITIZE})
  endif()
endfunction()
