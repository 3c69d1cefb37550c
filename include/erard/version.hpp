// The version of erard, written here and nowhere else: CMakeLists.txt reads it from this file.
#pragma once

#include <string_view>

namespace erard {

// major.minor.patch; before 1.0 each minor may break the interface
inline constexpr std::string_view kVersion = "0.1.0";

}  // namespace erard
