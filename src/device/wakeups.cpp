#include "erard/device/wakeups.hpp"

#include <cmath>
#include <memory>
#include <thread>

#include "erard/device/periodic_loop.hpp"

namespace erard {

Wakeups measure_wakeups(const WakeupRequest& request, const std::atomic<bool>& is_stopped) {
  Wakeups result;
  const auto loop = std::make_unique<PeriodicLoop<>>(LoopSettings{.period_ns = std::llround(1e9 / request.rate)});
  const auto periods = static_cast<std::int64_t>(request.rate * request.duration);
  std::thread thread([&] {
    const RealTime real_time(request.real_time);
    result.grants = real_time.grants();
    result.summary = loop->run([&](const Period& period) noexcept {
      return period.number + 1 < periods && !is_stopped.load(std::memory_order_relaxed);
    });
  });
  thread.join();
  result.lateness = loop->wake_lateness();
  return result;
}

}  // namespace erard
