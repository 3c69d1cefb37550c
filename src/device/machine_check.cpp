#include "erard/device/machine_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <set>

namespace erard {
namespace {

namespace fs = std::filesystem;

/// First line of a small file; empty when there is none.
std::string line_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

Finding check_kernel(const fs::path& root) {
  const std::string release = line_of(root / "proc/sys/kernel/osrelease"),
                    build = line_of(root / "proc/sys/kernel/version");
  if (build.find("PREEMPT_RT") != std::string::npos || line_of(root / "sys/kernel/realtime") == "1")
    return {"kernel", Verdict::ok, release + ", PREEMPT_RT"};
  return {"kernel", Verdict::warn, release + ", not PREEMPT_RT: waits for the kernel's own work",
          "install one with PREEMPT_RT: `sudo apt install linux-image-rt-amd64` on Debian, `sudo pro enable "
          "realtime-kernel` on Ubuntu"};
}

Finding check_isolation(const fs::path& root) {
  const std::string isolated = line_of(root / "sys/devices/system/cpu/isolated");
  const std::string no_tick = line_of(root / "sys/devices/system/cpu/nohz_full");
  const bool has_tickless = !no_tick.empty() && no_tick.find("null") == std::string::npos;
  if (!isolated.empty())
    return {"CPU isolation", Verdict::ok,
            fmt::format("isolcpus={}{}; use it: --cpu", isolated,
                        has_tickless ? fmt::format(", nohz_full={}", no_tick) : ", no nohz_full")};
  return {
      "CPU isolation", Verdict::warn, "no CPU is kept free of other work",
      "add `isolcpus=N nohz_full=N` to GRUB_CMDLINE_LINUX in /etc/default/grub, then `sudo update-grub` and restart"};
}

Finding check_throttling(const fs::path& root) {
  const std::string runtime = line_of(root / "proc/sys/kernel/sched_rt_runtime_us");
  const std::string period = line_of(root / "proc/sys/kernel/sched_rt_period_us");
  if (runtime.empty() || period.empty()) return {"throttling", Verdict::ok, "none is visible"};
  const long us = std::atol(runtime.c_str());
  if (us < 0) return {"throttling", Verdict::ok, "none: a thread that never sleeps would hold its CPU for good"};
  const double share = static_cast<double>(us) / std::max(1.0, std::atof(period.c_str()));
  const std::string found = fmt::format("real-time threads get {} us of {} us", runtime, period);
  if (share >= 0.5) return {"throttling", Verdict::ok, found + ": more than a loop that sleeps takes"};
  return {"throttling", us == 0 ? Verdict::fail : Verdict::warn, found,
          "give them more with `sudo sysctl kernel.sched_rt_runtime_us=950000`"};
}

/// Budget of real-time threads in this process's control group: CONFIG_RT_GROUP_SCHED with groups of version 1.
Finding check_group(const fs::path& root) {
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = fmt::format(",{},", line.substr(first + 1, second - first - 1));
    if (controllers.find(",cpu,") == std::string::npos) continue;
    const std::string group = line.substr(second + 1);
    for (const char* mount : {"sys/fs/cgroup/cpu", "sys/fs/cgroup/cpu,cpuacct"}) {
      const std::string budget = line_of(root / mount / fs::path(group).relative_path() / "cpu.rt_runtime_us");
      if (budget.empty()) continue;
      const std::string found = fmt::format("group {} has {} us of real time in each period", group, budget);
      if (std::atol(budget.c_str()) != 0) return {"group budget", Verdict::ok, found};
      return {"group budget", Verdict::fail, found,
              fmt::format("give it some with `echo 400000 | sudo tee /{}{}/cpu.rt_runtime_us`", mount, group)};
    }
  }
  return {"group budget", Verdict::ok, "control groups do not ration real time here"};
}

Finding check_frequency(const fs::path& root) {
  std::set<std::string> governors;
  std::error_code none;
  for (const auto& cpu : fs::directory_iterator(root / "sys/devices/system/cpu", none))
    if (const std::string governor = line_of(cpu.path() / "cpufreq/scaling_governor"); !governor.empty())
      governors.insert(governor);
  if (governors.empty())
    return {"CPU frequency", Verdict::ok, "no policy is visible, as in a virtual machine: the host decides"};
  std::string all;
  for (const std::string& governor : governors) all += (all.empty() ? "" : ", ") + governor;
  if (all == "performance") return {"CPU frequency", Verdict::ok, "governor performance"};
  return {"CPU frequency", Verdict::warn, fmt::format("governor {}: a loop that sleeps finds its CPU slow", all),
          "hold it with `sudo cpupower frequency-set -g performance` (package linux-cpupower)"};
}

Finding check_clock(const fs::path& root) {
  const std::string source = line_of(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
  constexpr std::array kFast = {"tsc", "kvm-clock", "arch_sys_counter", "hyperv_clocksource_tsc_page",
                                "riscv_clocksource"};
  if (source.empty()) return {"clock source", Verdict::ok, "not told"};
  if (std::find(kFast.begin(), kFast.end(), source) != kFast.end())
    return {"clock source", Verdict::ok, source + ", read without entering the kernel"};
  return {
      "clock source", Verdict::warn, source + ": each look enters the kernel and takes microseconds",
      "see in `dmesg | grep -i tsc` why the kernel gave up the faster one; a firmware update or `tsc=reliable` on the "
      "kernel's command line may bring it back"};
}

/// p99.9, or the worst where there are too few for that. [s]
double tail_of(const DurationHistogram& histogram) {
  constexpr long kEnough = 10'000;  // ten values beyond p99.9
  return histogram.total() >= kEnough ? histogram.quantile(0.999) : histogram.worst();
}

std::string quantiles_us(const DurationHistogram& histogram) {
  return fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f} us", 1e6 * histogram.quantile(0.5),
                     1e6 * histogram.quantile(0.99), 1e6 * histogram.quantile(0.999), 1e6 * histogram.worst());
}

Verdict grade(double value, double ok, double warn) {
  return value <= ok ? Verdict::ok : value <= warn ? Verdict::warn : Verdict::fail;
}

}  // namespace

std::vector<Finding> check_settings(const fs::path& root) {
  return {check_kernel(root), check_isolation(root), check_throttling(root),
          check_group(root),  check_frequency(root), check_clock(root)};
}

Finding judge(const Grant& grant, Verdict if_refused) {
  return {grant.what, grant.is_granted ? Verdict::ok : if_refused,
          grant.is_granted ? grant.granted : fmt::format("{} {}", grant.asked, grant.granted), grant.remedy};
}

Finding judge_wakeups(const Wakeups& wakeups, double period) {
  const LoopStatus& status = wakeups.summary.status;
  const std::string found = fmt::format("{} late in {} periods{}", quantiles_us(wakeups.lateness), status.periods,
                                        status.skipped > 0 ? fmt::format(", {} more skipped", status.skipped) : "");
  const Verdict verdict = grade(tail_of(wakeups.lateness), 0.1 * period, 0.3 * period);
  return {"waking", verdict, found,
          verdict == Verdict::ok
              ? ""
              : "mend the lines above, stop what else runs, and see with `cyclictest -p80 -m` whether it "
                "is the machine (a virtual one is stopped by its host)"};
}

Finding judge_round_trips(const RoundTrips& trips, double period) {
  const std::string found = fmt::format("{} and back, {} of {} lost (plain UDP, not LCM itself)",
                                        quantiles_us(trips.time), trips.lost, trips.sent);
  const Verdict verdict = trips.lost > 0 ? Verdict::fail : grade(tail_of(trips.time), 0.5 * period, period);
  return {
      "messages", verdict, found,
      verdict == Verdict::ok ? "" : "stop what else runs; the message takes two wake-ups, see the line about waking"};
}

Finding judge_route(const std::string& interface) {
  if (interface == "lo") return {"multicast route", Verdict::ok, "over lo: messages stay within this machine"};
  return {"multicast route", interface.empty() ? Verdict::fail : Verdict::warn,
          interface.empty() ? "none: LCM cannot start"
                            : fmt::format("over {}: LCM would tell the network about its groups", interface),
          "keep LCM within this machine with `sudo ip link set lo up && sudo ip route add 239.255.0.0/16 dev lo`"};
}

std::string findings_table(const std::vector<Finding>& findings) {
  constexpr std::array kWords = {"ok", "warn", "FAIL"};
  std::size_t width = 0;
  for (const Finding& finding : findings) width = std::max(width, finding.what.size());
  std::string table;
  for (const Finding& finding : findings) {
    table += fmt::format("{:<4}  {:<{}}  {}\n", kWords[static_cast<std::size_t>(finding.verdict)], finding.what, width,
                         finding.found);
    if (!finding.remedy.empty()) table += fmt::format("{:<{}}  -> {}\n", "", width + 6, finding.remedy);
  }
  return table;
}

Verdict worst_of(const std::vector<Finding>& findings) {
  Verdict worst = Verdict::ok;
  for (const Finding& finding : findings) worst = std::max(worst, finding.verdict);
  return worst;
}

}  // namespace erard
