# erard_own_target(<target>): the flags of erard's own libraries, programs, benchmarks and tests. All private: nothing
# here reaches the code of a host that links erard.
function(erard_own_target target)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wno-sign-conversion    # clang counts it to -Wconversion, g++ does not; indices are int here
    -ffp-contract=off)      # fused multiply-add rounds once, not twice: same bits with and without it
  if(ERARD_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(ERARD_SANITIZE)
    target_compile_options(${target} PRIVATE
      -fsanitize=${ERARD_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=${ERARD_SANITIZE})
  endif()
endfunction()
