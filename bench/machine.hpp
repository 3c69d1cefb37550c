// The machine that is measured, and what it grants.
#pragma once

#include <string>
#include <vector>

namespace erard::bench {

/// What a number was measured with.
struct Circumstances {
  std::string commit;    // git describe, or "unknown"
  std::string compiler;  // with version and flags
  std::string cpu;       // model name in /proc/cpuinfo, or "unknown"
  std::string kernel;
  std::string scheduling;     // of this process
  double clock_overhead = 0;  // [s], subtracted
  std::string peer;           // name and version; empty: not installed
};

Circumstances look_around();

/// CPUs that this process may use, the last first; empty when it is not told.
std::vector<int> usable_cpus();

}  // namespace erard::bench
