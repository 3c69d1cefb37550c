// The harness's clock, and what one look at it costs.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>

namespace erard::bench {

/// Steady time [ns]; the origin means nothing.
inline std::int64_t now() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// What an interval between two looks at the clock holds of the clock itself [ns]: the median of looks in a row. To be
/// subtracted from every measured interval, once for each look that it spans.
inline std::int64_t clock_overhead() noexcept {
  std::array<std::int64_t, 4001> interval;
  std::int64_t last = now();
  for (std::int64_t& each : interval) {
    const std::int64_t next = now();
    each = next - last;
    last = next;
  }
  const auto middle = interval.begin() + interval.size() / 2;
  std::nth_element(interval.begin(), middle, interval.end());
  return *middle;
}

}  // namespace erard::bench
