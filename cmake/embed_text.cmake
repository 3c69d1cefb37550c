# erard_embed_text(<target> <function> FILES <file>...): compiles text files into a target.
#   std::string_view erard::<function>(std::string_view name)    text of a file by its name without folder
# The .cpp is written anew when a file changes. Run as a script it is the writer itself.
if(CMAKE_SCRIPT_MODE_FILE)
  # a string literal is cut every 8000 characters: compilers need not take more than 65536 in one
  set(source "// Written by cmake/embed_text.cmake.\n#include <string_view>\n\nnamespace erard {\n")
  string(APPEND source "std::string_view ${FUNCTION}(std::string_view name);\n\nstd::string_view ${FUNCTION}(std::string_view name) {\n")
  separate_arguments(FILES UNIX_COMMAND "${FILES}")
  foreach(file IN LISTS FILES)
    get_filename_component(name "${file}" NAME)
    file(READ "${file}" text HEX)
    string(LENGTH "${text}" digits)
    math(EXPR size "${digits} / 2")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${text}")
    string(REGEX REPLACE "(('....',){24})" "\\1\n" bytes "${bytes}")
    string(MAKE_C_IDENTIFIER "${name}" identifier)
    string(APPEND source "  static constexpr char ${identifier}[] = {\n${bytes}'\\0'};\n"
                         "  if (name == \"${name}\") return {${identifier}, ${size}};\n")
  endforeach()
  string(APPEND source "  return {};\n}\n\n}  // namespace erard\n")
  file(WRITE "${OUTPUT}" "${source}")
  return()
endif()

set(erard_embed_text_script "${CMAKE_CURRENT_LIST_FILE}")

function(erard_embed_text target function)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "FILES")
  set(output "${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp")
  list(TRANSFORM arg_FILES PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" OUTPUT_VARIABLE files)
  list(JOIN files "\" \"" quoted)
  add_custom_command(OUTPUT "${output}"
    COMMAND "${CMAKE_COMMAND}" "-DFUNCTION=${function}" "-DOUTPUT=${output}" "-DFILES=\"${quoted}\""
            -P "${erard_embed_text_script}"
    DEPENDS ${files} "${erard_embed_text_script}"
    COMMENT "Embedding the pages of ${target}"
    VERBATIM)
  target_sources(${target} PRIVATE "${output}")
endfunction()
