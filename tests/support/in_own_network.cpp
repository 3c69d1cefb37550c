// in_own_network COMMAND [ARGUMENT..]: runs a command in a network of its own. Exit code 77 when that is not permitted.
#include <unistd.h>

#include <cstdio>

#include "own_network.hpp"

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const std::string refused = erard::test::enter_own_network();
  if (!refused.empty()) {
    std::printf("SKIPPED: %s\n", refused.c_str());
    return 77;
  }
  execvp(argv[1], argv + 1);
  std::perror(argv[1]);
  return 127;
}
