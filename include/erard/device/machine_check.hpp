// Is this machine fit to run a real-time loop? What its settings say, and how measurements are judged.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "erard/device/multicast.hpp"
#include "erard/device/real_time.hpp"
#include "erard/device/wakeups.hpp"

namespace erard {

enum class Verdict {
  ok,
  warn,  // it works, less well than it could
  fail,  // it does not
};

struct Finding {
  std::string what;
  Verdict verdict{};
  std::string found;
  std::string remedy{};  // one sentence with the command; empty where all is well
};

/// What the kernel tells of itself: version and preemption, isolated CPUs, throttling of real-time threads, their
/// budget in this control group, frequency policy, clock source.
/// @param root  of the file system: "/", or a copy of its proc and sys
std::vector<Finding> check_settings(const std::filesystem::path& root);

/// A grant as a finding. @param if_refused  how bad that is
Finding judge(const Grant& grant, Verdict if_refused);

/// Lateness of waking: p99.9 (the worst, where there are fewer than 10000) up to a tenth of the period is ok; up to
/// 3/10 it is a warning, the delay of the loop behind the device being 3/10 of the period at 2 kHz.
/// @param period  [s]
Finding judge_wakeups(const Wakeups& wakeups, double period);

/// Round trips likewise: up to half a period is ok, up to a whole one a warning, so that the answer to a position is
/// there before the next one. Any loss fails.
Finding judge_round_trips(const RoundTrips& trips, double period);

/// Whether LCM's addresses stay within this machine. @param interface  see interface_towards()
Finding judge_route(const std::string& interface);

/// Lines for a person: verdict, what, what was found, and below the remedy.
std::string findings_table(const std::vector<Finding>& findings);

Verdict worst_of(const std::vector<Finding>& findings);

}  // namespace erard
