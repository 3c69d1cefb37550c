// How punctually this machine wakes a real-time thread.
#pragma once

#include <atomic>
#include <vector>

#include "erard/device/duration_histogram.hpp"
#include "erard/device/loop_status.hpp"
#include "erard/device/real_time.hpp"

namespace erard {

struct WakeupRequest {
  double rate = 2000;    // [Hz]
  double duration = 10;  // [s]
  RealTimeRequest real_time;
};

struct Wakeups {
  DurationHistogram lateness;  // of each wake-up
  LoopSummary summary;
  std::vector<Grant> grants;  // with what it was measured
};

/// Runs an empty PeriodicLoop on a thread of its own.
/// @param is_stopped  ends it early; may be set by a signal handler
Wakeups measure_wakeups(const WakeupRequest& request, const std::atomic<bool>& is_stopped);

}  // namespace erard
