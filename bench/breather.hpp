// Leaves the CPU to others now and then.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

#include "bench/clock.hpp"

namespace erard::bench {

/// Under SCHED_FIFO a thread that never sleeps loses its CPU for 50 ms in every second (sched_rt_runtime_us), wherever
/// it is. It keeps it when it gives back a tenth of its own accord, between two ticks, as a host does in every period.
class Breather {
 public:
  explicit Breather(bool is_needed) : is_needed_(is_needed) {}

  void breathe() {
    constexpr std::int64_t kWorked = 10'000'000, kLongest = 100'000'000;  // [ns]
    const std::int64_t worked = now() - last_;
    if (!is_needed_ || worked < kWorked) return;
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(worked / 9, kLongest)));
    last_ = now();
  }

 private:
  bool is_needed_;
  std::int64_t last_ = now();
};

}  // namespace erard::bench
