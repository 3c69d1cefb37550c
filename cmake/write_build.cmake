# erard_write_build(<target>): compiles into a target what it was built from (git describe) and by what; bench/build.hpp
# has the functions. Looked up in every build; the .cpp changes only when the answer does.
if(CMAKE_SCRIPT_MODE_FILE)
  set(commit unknown)
  if(GIT)
    execute_process(COMMAND "${GIT}" describe --always --dirty WORKING_DIRECTORY "${SOURCE_DIR}"
                    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failure)
    if(NOT failure)
      set(commit "${described}")
    endif()
  endif()
  file(WRITE "${OUTPUT}.new"
    "// Written by cmake/write_build.cmake.\n#include \"bench/build.hpp\"\n\nnamespace erard::bench {\n\n"
    "std::string build_commit() { return R\"(${commit})\"; }\n"
    "std::string build_compiler() { return R\"(${COMPILER})\"; }\n\n}  // namespace erard::bench\n")
  execute_process(COMMAND "${CMAKE_COMMAND}" -E copy_if_different "${OUTPUT}.new" "${OUTPUT}")
  return()
endif()

set(erard_write_build_script "${CMAKE_CURRENT_LIST_FILE}")
find_package(Git QUIET)

function(erard_write_build target)
  set(output "${CMAKE_CURRENT_BINARY_DIR}/build.cpp")
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}" flags)
  set(compiler "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_SYSTEM_PROCESSOR}, ${flags}")
  if(ERARD_SANITIZE)
    string(APPEND compiler " -fsanitize=${ERARD_SANITIZE}")
  endif()
  add_custom_target(${target}_build BYPRODUCTS "${output}"
    COMMAND "${CMAKE_COMMAND}" "-DOUTPUT=${output}" "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}" "-DGIT=${GIT_EXECUTABLE}"
            "-DCOMPILER=${compiler}" -P "${erard_write_build_script}"
    COMMENT "Looking up the commit"
    VERBATIM)
  target_sources(${target} PRIVATE "${output}")
  add_dependencies(${target} ${target}_build)
endfunction()
