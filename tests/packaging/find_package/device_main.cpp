// A host of the compiled part, lying in <prefix>/bin: the default files are those of <prefix>/share/erard.
#include <erard/device/config_dir.hpp>
#include <erard/device/keystroke.hpp>

#include <cstdio>

int main() {
  const std::filesystem::path found = erard::config_dir();
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  std::printf("config_dir: %s\n", found.c_str());
  if (found != program.parent_path().parent_path() / "share/erard") return 1;
  erard::read_keystroke(found / "keystrokes" / "recorded_fast.csv");
  return 0;
}
