#include "erard/device/config_dir.hpp"

#include <cstdlib>
#include <string>
#include <system_error>

#include "erard/device/error.hpp"

namespace erard {

namespace fs = std::filesystem;

namespace {

// Unreadable counts as absent: the next candidate may do.
bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// Empty where /proc is not mounted.
fs::path folder_of_program() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path();
}

}  // namespace

fs::path config_dir() {
  // what the user says is used or refused, never passed over in silence
  if (const char* chosen = std::getenv("ERARD_CONFIG_DIR"); chosen != nullptr && *chosen != '\0') {
    if (!is_folder(chosen))
      throw InputError("environment: ERARD_CONFIG_DIR = " + std::string(chosen) +
                       ", must be a folder; unset it to use the files that come with erard");
    return chosen;
  }

  const fs::path beside_program = (folder_of_program() / "../share/erard").lexically_normal();
  const fs::path source_tree = ERARD_SOURCE_CONFIG_DIR;
  const fs::path install_prefix = ERARD_INSTALLED_CONFIG_DIR;
  for (const fs::path& candidate : {beside_program, source_tree, install_prefix})
    if (is_folder(candidate)) return candidate;

  throw InputError("the files that come with erard are in none of " + beside_program.string() + ", " +
                   source_tree.string() + ", " + install_prefix.string() +
                   "; set ERARD_CONFIG_DIR to the folder that holds them");
}

}  // namespace erard
