// A clock that is told what happens.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>

#include "erard/device/monotonic_clock.hpp"

namespace erard::test {

inline constexpr std::int64_t us = 1000;      // [ns]
inline constexpr std::int64_t kT = 500 * us;  // period
inline constexpr std::int64_t kWork = 50 * us;

/// Time that passes only where a test says so.
struct FakeTime {
  std::int64_t now = 7 * us;
  std::int64_t cpu = 0;
  std::deque<std::int64_t> wake_delays;  // of the next sleeps; none left: 0
  ThreadUsage usage;

  void work(std::int64_t wall, std::int64_t on_cpu) {
    now += wall;
    cpu += on_cpu;
  }
};

struct FakeClock {
  FakeTime* time;
  std::int64_t now() const noexcept { return time->now; }
  std::int64_t thread_cpu_time() const noexcept { return time->cpu; }
  ThreadUsage thread_usage() const noexcept { return time->usage; }
  void sleep_until(std::int64_t until) const noexcept {
    time->now = std::max(time->now, until);
    if (time->wake_delays.empty()) return;
    time->now += time->wake_delays.front();
    time->wake_delays.pop_front();
  }
};

}  // namespace erard::test
