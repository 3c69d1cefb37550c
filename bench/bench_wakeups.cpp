// How late the real-time loop wakes up, as cyclictest tells it of itself; tools/compare-cyclictest runs both in turn.
//   build/release/bin/bench_wakeups [SECONDS, 10] [CPU, any] [PRIORITY, 80] [RATE IN HZ, 2000]
// Prints p50, p99, p99.9 and the maximum in us, counts of periods, page faults and switches. Exit code 1 when real time
// was refused.
#include <fmt/format.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>

#include "erard/device/wakeups.hpp"

int main(int argc, char** argv) {
  using namespace erard;
  WakeupRequest request;
  if (argc > 1) request.duration = std::atof(argv[1]);
  if (argc > 2) request.real_time.cpu = std::atoi(argv[2]);
  if (argc > 3) request.real_time.priority = std::atoi(argv[3]);
  if (argc > 4) request.rate = std::atof(argv[4]);
  const std::atomic<bool> is_stopped{false};
  const Wakeups wakeups = measure_wakeups(request, is_stopped);
  for (const Grant& grant : wakeups.grants)
    if (!grant.is_granted) {
      fmt::print(stderr, "{}", grant_table(wakeups.grants));
      return 1;
    }
  const LoopStatus& status = wakeups.summary.status;
  fmt::print(
      "p50_us {:.2f} p99_us {:.2f} p999_us {:.2f} max_us {:.2f} periods {} skipped {} minor_faults {} "
      "involuntary_switches {}\n",
      1e6 * wakeups.lateness.quantile(0.5), 1e6 * wakeups.lateness.quantile(0.99),
      1e6 * wakeups.lateness.quantile(0.999), 1e6 * wakeups.lateness.worst(), status.periods, status.skipped,
      wakeups.summary.usage.minor_faults, wakeups.summary.usage.involuntary_switches);
}
