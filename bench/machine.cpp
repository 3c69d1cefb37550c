#include "bench/machine.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/utsname.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "bench/build.hpp"
#include "bench/clock.hpp"
#include "bench/contender.hpp"

namespace erard::bench {
namespace {

constexpr int kPriority = 80;  // of SCHED_FIFO: above threaded interrupts (50), below the kernel's own watchdogs (99)

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string kernel() {
  utsname names{};
  return uname(&names) == 0 ? fmt::format("{} {}", names.sysname, names.release) : "unknown";
}

}  // namespace

Circumstances look_around() {
  return {build_commit(),  build_compiler(), cpu_model(), kernel(), {}, 1e-9 * static_cast<double>(clock_overhead()),
          mujoco_version()};
}

std::vector<int> usable_cpus() {
  cpu_set_t allowed;
  std::vector<int> cpus;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return cpus;
  for (int cpu = CPU_SETSIZE - 1; cpu >= 0; --cpu)
    if (CPU_ISSET(cpu, &allowed)) cpus.push_back(cpu);
  return cpus;
}

bool pin_to(int cpu) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(cpu, &one);
  return sched_setaffinity(0, sizeof one, &one) == 0;
}

std::vector<std::string> request_real_time() {
  std::vector<std::string> refused;
  const sched_param priority{kPriority};
  if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0)
    refused.push_back(
        fmt::format("SCHED_FIFO with priority {} was refused ({}); allow it with `ulimit -r {}` (rtprio in "
                    "/etc/security/limits.conf) or run as root",
                    kPriority, std::strerror(errno), kPriority));
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    refused.push_back(
        fmt::format("locking the memory was refused ({}); allow it with `ulimit -l unlimited` (memlock in "
                    "/etc/security/limits.conf) or run as root",
                    std::strerror(errno)));
  return refused;
}

}  // namespace erard::bench
