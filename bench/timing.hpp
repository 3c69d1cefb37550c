// Times of short pieces of work, and how far they can be trusted.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace erard::bench {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Shortest and median time of one call [s].
struct Times {
  double shortest = 0, median = 0;
};

inline Times times_of(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  return {samples.front(), samples[samples.size() / 2]};
}

/// The same work every time, some 20 us: what it varies by is not ours.
inline double fixed_work() {
  volatile double sink = 1;
  double x = sink;
  for (int i = 0; i < 6000; ++i) x = 1.0000001 * x + 1e-9;  // each waits for the one before
  sink = x;
  return sink;
}

/// Calls a piece of work until its time is known: as often as fits into `budget`, at least 3 times, at most 400; short ones
/// several times between two looks at the clock, which takes some 30 ns.
template <typename Work>
Times measure(Work&& work, double budget = 0.02) {
  const auto first = Clock::now();
  work();  // warms the caches up
  const double once = std::max(seconds_since(first), 1e-9);
  const int batch = std::max(1, static_cast<int>(5e-6 / once));
  const int repeats = std::clamp(static_cast<int>(budget / (batch * once)), 3, 400);
  std::vector<double> samples;
  for (int k = 0; k < repeats; ++k) {
    const auto start = Clock::now();
    for (int i = 0; i < batch; ++i) work();
    samples.push_back(seconds_since(start) / batch);
  }
  return times_of(std::move(samples));
}

}  // namespace erard::bench
