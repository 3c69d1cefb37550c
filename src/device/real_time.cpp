#include "erard/device/real_time.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace erard {
namespace {

constexpr const char* kLatencyDevice = "/dev/cpu_dma_latency";
constexpr std::size_t kRoom = std::size_t{64} << 20;  // [B] that may still be asked for: threads, recorder
constexpr std::size_t kStack = 256 * 1024;  // [B] touched: several times what the engine and the C library use

std::string refused(int error) { return fmt::format("refused ({})", std::strerror(error)); }

std::string limits_remedy(const char* item, const std::string& value) {
  return fmt::format(
      "allow it with `echo \"$USER - {0} {1}\" | sudo tee -a /etc/security/limits.d/erard.conf` and log in again, or "
      "run "
      "as root",
      item, value);
}

std::string scheduler_in_force() {
  sched_param parameters{};
  const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  sched_getparam(0, &parameters);
  if (policy == SCHED_FIFO) return fmt::format("SCHED_FIFO {}", parameters.sched_priority);
  return policy == SCHED_RR ? fmt::format("SCHED_RR {}", parameters.sched_priority) : "ordinary scheduling";
}

std::string cpus_in_force() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) return "unknown";
  std::string list;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &set)) list += fmt::format("{}{}", list.empty() ? "" : ",", cpu);
  return fmt::format("CPU {}", list);
}

/// VmLck of this process [kB], as the kernel counts it; -1 when it does not tell.
long locked_kB() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmLck:")) return std::atol(line.c_str() + 6);
  return -1;
}

/// Whether memory taken from now on can be locked too: under a limit it could not be had at all.
bool has_room_to_grow() {
  void* probe = mmap(nullptr, kRoom, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (probe == MAP_FAILED) return false;
  munmap(probe, kRoom);
  return true;
}

/// Writes to every page of the stack that the real-time work may reach.
[[gnu::noinline]] void touch_stack() {
  char stack[kStack];
  for (std::size_t i = 0; i < kStack; i += 4096) stack[i] = 0;
  asm volatile("" : : "r"(stack) : "memory");  // or it would be optimised away
}

}  // namespace

Grant request_fifo(int priority) {
  Grant grant{"scheduler", fmt::format("SCHED_FIFO {}", priority), {}, true, {}};
  const sched_param parameters{priority};
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) == 0) {
    grant.granted = scheduler_in_force();
    return grant;
  }
  const int error = errno;
  grant.is_granted = false;
  grant.granted = fmt::format("{}, {}", refused(error), scheduler_in_force());
  if (error == EINVAL)
    grant.remedy = "name a priority from 1 to 99";
  else if (geteuid() == 0)
    grant.remedy =
        "root too is refused where the control group has no real-time budget: `echo 950000 > "
        "/sys/fs/cgroup/cpu/<group>/cpu.rt_runtime_us`, or in a container --cap-add SYS_NICE";
  else
    grant.remedy = limits_remedy("rtprio", std::to_string(priority));
  return grant;
}

Grant request_cpu(int cpu) {
  Grant grant{"CPU", fmt::format("CPU {}", cpu), {}, true, {}};
  int error = EINVAL;
  if (cpu >= 0 && cpu < CPU_SETSIZE) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(cpu, &set);
    error = sched_setaffinity(0, sizeof set, &set) == 0 ? 0 : errno;
  }
  if (error == 0) {
    grant.granted = cpus_in_force();
    return grant;
  }
  grant.is_granted = false;
  grant.granted = fmt::format("{}, {}", refused(error), cpus_in_force());
  grant.remedy = fmt::format("name a CPU that this process may use: {} (`taskset -cp $$`)", cpus_in_force());
  return grant;
}

Grant request_memory_lock() {
  Grant grant{"memory", "locked", {}, true, {}};
  const int error = mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
  touch_stack();
  const bool is_limited = error == 0 && !has_room_to_grow();
  if (is_limited) munlockall();
  if (error == 0 && !is_limited) {
    grant.granted = fmt::format("locked, {} MB", (locked_kB() + 999) / 1000);
    return grant;
  }
  grant.is_granted = false;
  grant.granted = is_limited ? "refused (the limit leaves no room to grow)" : refused(error);
  grant.remedy = limits_remedy("memlock", "unlimited");
  return grant;
}

Grant request_timer_slack(std::int64_t slack_ns) {
  Grant grant{"timer slack", fmt::format("{} ns", slack_ns), {}, true, {}};
  prctl(PR_SET_TIMERSLACK, static_cast<unsigned long>(slack_ns), 0, 0, 0);
  const int in_force = prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0);
  grant.granted = in_force < 0 ? "unknown" : fmt::format("{} ns", in_force);
  grant.is_granted = in_force >= 0 && in_force <= slack_ns;
  if (!grant.is_granted) grant.remedy = "have SCHED_FIFO granted, under which the slack is 0";
  return grant;
}

CpuLatencyHold::CpuLatencyHold() : grant_{"CPU sleep", "wake at once", {}, true, {}} {
  const std::int32_t latency_us = 0;
  file_ = open(kLatencyDevice, O_WRONLY | O_CLOEXEC);
  const bool is_written = file_ >= 0 && write(file_, &latency_us, sizeof latency_us) == sizeof latency_us;
  if (is_written) {
    grant_.granted = fmt::format("wake at once ({} holds 0 us)", kLatencyDevice);
    return;
  }
  const int error = errno;
  grant_.is_granted = false;
  grant_.granted = refused(error);
  grant_.remedy =
      error == ENOENT
          ? fmt::format("make {} visible to this process (in a container: --device {})", kLatencyDevice, kLatencyDevice)
          : "allow it with `echo 'KERNEL==\"cpu_dma_latency\", MODE=\"0666\"' | sudo tee "
            "/etc/udev/rules.d/99-erard.rules && sudo udevadm trigger --name-match cpu_dma_latency`, or run as root";
}

CpuLatencyHold::~CpuLatencyHold() {
  if (file_ >= 0) close(file_);
}

RealTime::RealTime(const RealTimeRequest& request) {
  grants_.push_back(request_timer_slack(1));  // before SCHED_FIFO, which takes no slack
  if (request.cpu != RealTimeRequest::kAnyCpu) grants_.push_back(request_cpu(request.cpu));
  grants_.push_back(request_memory_lock());
  grants_.push_back(latency_.grant());
  grants_.push_back(request_fifo(request.priority));
}

bool RealTime::is_granted() const noexcept {
  return std::all_of(grants_.begin(), grants_.end(), [](const Grant& grant) { return grant.is_granted; });
}

std::string grant_table(const std::vector<Grant>& grants) {
  std::size_t what = 0, asked = 0;
  for (const Grant& grant : grants) {
    what = std::max(what, grant.what.size());
    asked = std::max(asked, grant.asked.size());
  }
  std::string table;
  for (const Grant& grant : grants) {
    table += fmt::format("{:<{}}  {:<{}}  {}\n", grant.what, what, grant.asked, asked, grant.granted);
    if (!grant.is_granted) table += fmt::format("{:<{}}  -> {}\n", "", what, grant.remedy);
  }
  return table;
}

}  // namespace erard
