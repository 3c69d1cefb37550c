// erard-check as its users meet it, and what it makes of other machines. Nothing here asks how good this one is.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <map>

#include "erard/device/machine_check.hpp"
#include "support/program.hpp"

namespace erard {
namespace {

using test::expect_one_sentence;
using test::run_program;
using test::TemporaryFolder;

/// A machine as its proc and sys tell it.
class FakeMachine {
 public:
  void tell(const std::string& file, const std::string& text) {
    std::filesystem::create_directories((folder_ / file).parent_path());
    test::write_text(folder_ / file, text + "\n");
  }
  std::map<std::string, Finding> findings() const {
    std::map<std::string, Finding> by_name;
    for (const Finding& finding : check_settings(folder_.path())) by_name[finding.what] = finding;
    return by_name;
  }
  Verdict verdict(const std::string& what) const { return findings().at(what).verdict; }

 private:
  TemporaryFolder folder_;
};

TEST(MachineCheck, KnowsARealTimeKernel) {
  FakeMachine machine;
  machine.tell("proc/sys/kernel/osrelease", "6.1.0-rt-amd64");
  machine.tell("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian");
  EXPECT_EQ(machine.verdict("kernel"), Verdict::warn);
  machine.tell("proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian");
  EXPECT_EQ(machine.verdict("kernel"), Verdict::ok);
  EXPECT_NE(machine.findings().at("kernel").found.find("6.1.0-rt-amd64"), std::string::npos);
}

TEST(MachineCheck, KnowsIsolatedCpus) {
  FakeMachine machine;
  machine.tell("sys/devices/system/cpu/isolated", "");
  machine.tell("sys/devices/system/cpu/nohz_full", "(null)");
  EXPECT_EQ(machine.verdict("CPU isolation"), Verdict::warn);
  machine.tell("sys/devices/system/cpu/isolated", "3");
  EXPECT_EQ(machine.verdict("CPU isolation"), Verdict::ok);
  EXPECT_NE(machine.findings().at("CPU isolation").found.find("isolcpus=3, no nohz_full"), std::string::npos);
  machine.tell("sys/devices/system/cpu/nohz_full", "3");
  EXPECT_NE(machine.findings().at("CPU isolation").found.find("isolcpus=3, nohz_full=3"), std::string::npos);
}

TEST(MachineCheck, JudgesThrottlingByTheShareThatIsLeft) {
  FakeMachine machine;
  EXPECT_EQ(machine.verdict("throttling"), Verdict::ok);
  machine.tell("proc/sys/kernel/sched_rt_period_us", "1000000");
  const std::map<std::string, Verdict> cases = {{"950000", Verdict::ok},
                                                {"-1", Verdict::ok},
                                                {"500000", Verdict::ok},
                                                {"499999", Verdict::warn},
                                                {"0", Verdict::fail}};
  for (const auto& [runtime, verdict] : cases) {
    machine.tell("proc/sys/kernel/sched_rt_runtime_us", runtime);
    EXPECT_EQ(machine.verdict("throttling"), verdict) << runtime;
  }
}

TEST(MachineCheck, FindsTheBudgetOfItsOwnControlGroup) {
  FakeMachine machine;
  EXPECT_EQ(machine.verdict("group budget"), Verdict::ok);
  machine.tell("proc/self/cgroup", "5:cpuset:/elsewhere\n3:cpu,cpuacct:/a/b\n0::/a");
  EXPECT_EQ(machine.verdict("group budget"), Verdict::ok);  // no file: not rationed
  machine.tell("sys/fs/cgroup/cpu/a/b/cpu.rt_runtime_us", "0");
  EXPECT_EQ(machine.verdict("group budget"), Verdict::fail);
  EXPECT_NE(machine.findings().at("group budget").remedy.find("/sys/fs/cgroup/cpu/a/b/cpu.rt_runtime_us"),
            std::string::npos);
  machine.tell("sys/fs/cgroup/cpu/a/b/cpu.rt_runtime_us", "950000");
  EXPECT_EQ(machine.verdict("group budget"), Verdict::ok);
}

TEST(MachineCheck, WantsEveryCpuAtItsPerformance) {
  FakeMachine machine;
  EXPECT_EQ(machine.verdict("CPU frequency"), Verdict::ok);  // none is visible
  machine.tell("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
  EXPECT_EQ(machine.verdict("CPU frequency"), Verdict::ok);
  machine.tell("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave");
  EXPECT_EQ(machine.verdict("CPU frequency"), Verdict::warn);
}

TEST(MachineCheck, KnowsSlowClocks) {
  FakeMachine machine;
  const std::map<std::string, Verdict> cases = {
      {"tsc", Verdict::ok}, {"kvm-clock", Verdict::ok}, {"hpet", Verdict::warn}, {"acpi_pm", Verdict::warn}};
  for (const auto& [source, verdict] : cases) {
    machine.tell("sys/devices/system/clocksource/clocksource0/current_clocksource", source);
    EXPECT_EQ(machine.verdict("clock source"), verdict) << source;
  }
}

DurationHistogram histogram(long count, double most, long beyond, double worst) {
  DurationHistogram result;
  for (long i = 0; i < count; ++i) result.add(i < beyond ? worst : most);
  return result;
}

TEST(MachineCheck, JudgesWakingByItsTail) {
  const auto verdict = [](const DurationHistogram& lateness) {
    Wakeups wakeups;
    wakeups.lateness = lateness;
    return judge_wakeups(wakeups, 500e-6).verdict;
  };
  EXPECT_EQ(verdict(histogram(10'000, 20e-6, 10, 1)), Verdict::ok);  // one in a thousand may be anything
  EXPECT_EQ(verdict(histogram(10'000, 20e-6, 11, 1)), Verdict::fail);
  EXPECT_EQ(verdict(histogram(10'000, 20e-6, 11, 100e-6)), Verdict::warn);
  EXPECT_EQ(verdict(histogram(9'999, 20e-6, 1, 1)), Verdict::fail);  // too few for that: the worst counts
}

TEST(MachineCheck, JudgesMessagesByTheirTailAndFailsOnLoss) {
  RoundTrips trips{histogram(20'000, 60e-6, 20, 1), 20'000, 0};
  EXPECT_EQ(judge_round_trips(trips, 500e-6).verdict, Verdict::ok);
  trips.time = histogram(20'000, 400e-6, 0, 0);
  EXPECT_EQ(judge_round_trips(trips, 500e-6).verdict, Verdict::warn);
  trips.time = histogram(20'000, 600e-6, 0, 0);
  EXPECT_EQ(judge_round_trips(trips, 500e-6).verdict, Verdict::fail);
  trips = {histogram(19'999, 60e-6, 0, 0), 20'000, 1};
  EXPECT_EQ(judge_round_trips(trips, 500e-6).verdict, Verdict::fail);
}

TEST(MachineCheck, WantsMulticastOverLoopback) {
  EXPECT_EQ(judge_route("lo").verdict, Verdict::ok);
  EXPECT_EQ(judge_route("eth0").verdict, Verdict::warn);
  EXPECT_EQ(judge_route("").verdict, Verdict::fail);
}

TEST(MachineCheck, HasARemedyForWhateverIsNotWell) {
  FakeMachine machine;
  machine.tell("proc/sys/kernel/sched_rt_period_us", "1000000");
  machine.tell("proc/sys/kernel/sched_rt_runtime_us", "0");
  machine.tell("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave");
  machine.tell("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet");
  int troubles = 0;
  for (const auto& [what, finding] : machine.findings()) {
    EXPECT_EQ(finding.remedy.empty(), finding.verdict == Verdict::ok) << what;
    troubles += finding.verdict != Verdict::ok;
  }
  EXPECT_EQ(troubles, 5);
}

/// Runs a claim in a process without any rights. @return whether it held
bool holds_without_rights(const std::function<bool()>& claim) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit none{0, 0};
    for (const auto resource : {RLIMIT_RTPRIO, RLIMIT_MEMLOCK}) setrlimit(resource, &none);
    if (geteuid() == 0 && setuid(65534) != 0) _exit(2);
    _exit(claim() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(RealTimeRequests, AreRefusedAloudWithTheCommandThatHelps) {
  EXPECT_TRUE(holds_without_rights([] {
    const Grant grant = request_fifo(80);
    return !grant.is_granted && grant.granted == "refused (Operation not permitted), ordinary scheduling" &&
           grant.remedy.find("$USER - rtprio 80") != std::string::npos;
  }));
}

#ifndef __SANITIZE_ADDRESS__  // which answers requests to lock memory itself: they would fill it with its shadow
TEST(RealTimeRequests, AMemoryLockWithoutTheRightIsRefused) {
  EXPECT_TRUE(holds_without_rights([] {
    const Grant grant = request_memory_lock();
    return !grant.is_granted && grant.remedy.find("$USER - memlock unlimited") != std::string::npos;
  }));
}
#endif

TEST(RealTimeRequests, ThatNobodyIsGrantedNameWhatCanBeHad) {
  const Grant priority = request_fifo(100);
  EXPECT_FALSE(priority.is_granted);
  EXPECT_EQ(priority.remedy, "name a priority from 1 to 99");
  for (const int cpu : {-2, CPU_SETSIZE - 1, CPU_SETSIZE}) {
    const Grant grant = request_cpu(cpu);
    EXPECT_FALSE(grant.is_granted) << cpu;
    EXPECT_NE(grant.remedy.find("name a CPU that this process may use"), std::string::npos);
  }
}

TEST(RealTimeRequests, TellWhatTheKernelHasNotWhatWasAsked) {
  EXPECT_TRUE(holds_without_rights([] {
    const Grant grant = request_timer_slack(1);  // needs no right
    return grant.is_granted && grant.granted == "1 ns";
  }));
}

TEST(RealTimeRequests, AreAllInTheTableWithTheirRemedies) {
  EXPECT_TRUE(holds_without_rights([] {
    const RealTime real_time({.priority = 70, .cpu = 0});
    const std::string table = grant_table(real_time.grants());
    for (const char* piece : {"timer slack", "CPU 0", "memory", "CPU sleep", "SCHED_FIFO 70", "-> allow it with"})
      if (table.find(piece) == std::string::npos) return false;
    return !real_time.is_granted();
  }));
}

TEST(InterfaceTowards, KnowsLoopbackAndSendsNothing) {
  if (access("/sys/class/net/lo", F_OK) != 0) GTEST_SKIP() << "no network at all";
  const std::string interface = interface_towards("127.0.0.1");
  EXPECT_TRUE(interface == "lo" || interface.empty()) << interface;  // empty while it is down
  EXPECT_THROW(interface_towards("localhost"), std::runtime_error);
}

TEST(ErardCheck, TellsEveryLineAndAVerdict) {
  const test::Outcome outcome = run_program("erard-check --seconds 1 --rate 400");
  EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 1) << outcome.error;
  for (const char* line : {"kernel", "CPU isolation", "throttling", "group budget", "CPU frequency", "clock source",
                           "scheduler", "memory", "CPU sleep", "waking", "multicast route", "messages"})
    EXPECT_NE(outcome.out.find(line), std::string::npos) << line;
  const bool fails = outcome.out.find("\nFAIL  ") != std::string::npos || outcome.out.starts_with("FAIL  ");
  EXPECT_EQ(outcome.exit_code, fails ? 1 : 0) << outcome.out;
  EXPECT_NE(outcome.out.find(fails ? "is not fit" : "This machine"), std::string::npos);
}

TEST(ErardCheck, MeasuresMessagesOnlyWhereTheyStayOnTheMachine) {
  // networks of their own, where they may be made
  const std::string check = std::string(ERARD_PROGRAM_DIR) + "/erard-check --seconds 1 --rate 400";
  const auto in_network = [&](const std::string& setup) {
    return test::run_program("erard-check --version > /dev/null; unshare -rn sh -c '" + setup + check + "'");
  };
  if (in_network("ip link > /dev/null && ").out.empty()) GTEST_SKIP() << "networks cannot be made here (unshare, ip)";
  EXPECT_NE(in_network("").out.find("none: LCM cannot start"), std::string::npos);
  EXPECT_NE(in_network("ip link set lo up; ip route add 239.255.0.0/16 dev lo; ").out.find("(plain UDP"),
            std::string::npos);
  const std::string outside =
      in_network(
          "ip link set lo up; ip link add veth0 type veth peer name veth1; ip addr add 10.9.8.7/24 dev veth0; "
          "ip link set veth0 up; ip link set veth1 up; ip route add default dev veth0; ")
          .out;
  EXPECT_NE(outside.find("over veth0"), std::string::npos) << outside;
  EXPECT_NE(outside.find("not measured"), std::string::npos) << outside;
}

TEST(ErardCheck, RefusesWhatItCannotDoInOneSentence) {
  expect_one_sentence(run_program("erard-check --seconds 0"), {"--seconds = 0", "must be 1 to 3600"});
  expect_one_sentence(run_program("erard-check --rate 100"), {"--rate = 100", "must be 400 to 50000"});
  expect_one_sentence(run_program("erard-check --cpu 1023"), {"--cpu = 1023", "may use"});
  expect_one_sentence(run_program("erard-check --priority 100"), {"--priority = 100", "must be 11 to 99"});
  expect_one_sentence(run_program("erard-check --loud"), {"--loud"});
}

TEST(ErardCheck, HelpTellsUnitsAndExitCodes) {
  const test::Outcome outcome = run_program("erard-check --help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* piece : {"--seconds", "--rate", "--cpu", "--priority", "Hz", "Exit codes"})
    EXPECT_NE(outcome.out.find(piece), std::string::npos) << piece;
}

}  // namespace
}  // namespace erard
