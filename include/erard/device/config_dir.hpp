// Where the actions, keystrokes and settings that come with erard are found.
#pragma once

#include <filesystem>

namespace erard {

/// Folder with the default action and keystrokes. The first that applies:
///   1. the environment variable ERARD_CONFIG_DIR, if set and not empty
///   2. <folder of the running program>/../share/erard     an installed program, wherever it was moved to
///   3. config/ of the source tree this library was built from     a program run from the build tree
///   4. share/erard under the install prefix given to CMake     a host installed elsewhere than erard
/// Throws InputError when the variable names no folder, or when none of the others exists.
std::filesystem::path config_dir();

}  // namespace erard
