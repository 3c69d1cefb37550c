// What this program was built from, and by what. Written by CMake.
#pragma once

#include <string>

namespace erard::bench {

std::string build_commit();    // `git describe --always --dirty`, or "unknown"
std::string build_compiler();  // "GNU 12.2.0 x86_64, -O3 -DNDEBUG"

}  // namespace erard::bench
