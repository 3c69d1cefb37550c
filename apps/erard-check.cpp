// erard-check: is this machine fit for the real-time loop, and what to do where it is not.
#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <future>
#include <string>
#include <vector>

#include "erard/device/error.hpp"
#include "erard/device/machine_check.hpp"
#include "program.hpp"

namespace {

using namespace erard;

constexpr const char* kLcmGroup = "239.255.76.67";  // LCM's default; 239.255/16 is where its kin are

std::atomic<bool> is_interrupted{false};

struct Options {
  double seconds = 10, rate_Hz = 2000;
  int cpu = RealTimeRequest::kAnyCpu, priority = 80;
};

void add_options(CLI::App& app, Options& o) {
  app.add_option("--seconds", o.seconds,
                 "how long waking is measured, 1 to 3600 s; messages take a fifth of it (p99.9 is judged from 10000 "
                 "periods on, the worst one of fewer)")
      ->capture_default_str();
  app.add_option("--rate", o.rate_Hz, "rate of the loop, 400 to 50000 Hz")->capture_default_str();
  app.add_option("--cpu", o.cpu, "CPU to bind to (default: any)");
  app.add_option("--priority", o.priority, "of SCHED_FIFO, 11 to 99")->capture_default_str();
}

void check(const Options& o) {
  if (!(o.seconds >= 1 && o.seconds <= 3600))
    throw InputError(fmt::format("--seconds = {}, must be 1 to 3600 s", o.seconds));
  if (!(o.rate_Hz >= 400 && o.rate_Hz <= 50000))
    throw InputError(fmt::format("--rate = {}, must be 400 to 50000 Hz", o.rate_Hz));
  if (o.priority < 11 || o.priority > 99)
    throw InputError(fmt::format("--priority = {}, must be 11 to 99", o.priority));
  if (o.cpu == RealTimeRequest::kAnyCpu) return;
  cpu_set_t usable;
  CPU_ZERO(&usable);
  sched_getaffinity(0, sizeof usable, &usable);
  if (o.cpu < 0 || o.cpu >= CPU_SETSIZE || !CPU_ISSET(o.cpu, &usable))
    throw InputError(fmt::format("--cpu = {}, must be a CPU that this process may use (`taskset -cp $$`)", o.cpu));
}

/// Does something on another thread, and counts the seconds on a terminal meanwhile.
template <class Work>
auto show_progress(const char* what, double seconds, Work work) {
  auto result = std::async(std::launch::async, work);
  const bool is_shown = isatty(STDERR_FILENO) != 0 && seconds > 2;
  for (double left = seconds; result.wait_for(std::chrono::seconds(1)) != std::future_status::ready; left -= 1)
    if (is_shown) fmt::print(stderr, "\r{}: {:.0f} s left ", what, std::max(0.0, left - 1));
  if (is_shown) fmt::print(stderr, "\r{:<40}\r", "");
  return result.get();
}

void measure_waking(const Options& o, std::vector<Finding>& findings) {
  const WakeupRequest request{o.rate_Hz, o.seconds, {o.priority, o.cpu}};
  const Wakeups wakeups =
      show_progress("waking", o.seconds, [request] { return measure_wakeups(request, is_interrupted); });
  for (const Grant& grant : wakeups.grants) {
    const bool is_vital = grant.what == "scheduler" || grant.what == "memory";
    findings.push_back(judge(grant, is_vital ? Verdict::fail : Verdict::warn));
  }
  findings.push_back(judge_wakeups(wakeups, 1 / o.rate_Hz));
}

/// Only where the route leads over loopback: elsewhere a program that joins LCM's groups is heard in the network.
void measure_messages(const Options& o, std::vector<Finding>& findings) {
  const std::string interface = interface_towards(kLcmGroup);
  findings.push_back(judge_route(interface));
  if (interface != "lo") {
    findings.push_back({"messages", Verdict::warn, "not measured without that route"});
    return;
  }
  const RoundTripRequest request{o.rate_Hz, o.seconds / 5, {o.priority, o.cpu}};
  findings.push_back(judge_round_trips(
      show_progress("messages", o.seconds / 5, [request] { return measure_round_trips(request, is_interrupted); }),
      1 / o.rate_Hz));
}

int run(const Options& o) {
  check(o);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { is_interrupted = true; });
  std::vector<Finding> findings = check_settings("/");
  measure_waking(o, findings);
  if (!is_interrupted) measure_messages(o, findings);
  fmt::print("{}", findings_table(findings));
  if (is_interrupted) return kInterrupted;
  const Verdict worst = worst_of(findings);
  fmt::print("\n{}\n", worst == Verdict::ok     ? "This machine is fit for the loop."
                       : worst == Verdict::warn ? "This machine runs the loop; it could do so better."
                                                : "This machine is not fit for the loop as it is.");
  if (std::fflush(stdout) != 0) throw std::runtime_error("the table could not be written to the standard output");
  return worst == Verdict::fail ? kFailed : kDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Checks whether this machine is fit for the real-time loop: settings, rights, waking, messages.",
               "erard-check");
  app.footer(
      "Waking: lateness of an empty loop's wake-ups; p99.9 up to a tenth of the period is ok, up to 3/10 a warning.\n"
      "Messages: a datagram to another thread and back over loopback multicast, as LCM sends it; p99.9 up to half a\n"
      "period is ok, up to a whole one a warning. Nothing leaves the machine. docs/real_time.md explains each line.\n"
      "Exit codes: 0 fit, warnings included; 1 something fails or cannot be measured; 2 bad option; 130 interrupted.");
  Options options;
  add_options(app, options);
  return erard::run_program(app, argc, argv, [&] { return run(options); });
}
