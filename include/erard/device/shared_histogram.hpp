// Quantiles of what one thread measures, while another looks.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>

#include "erard/device/duration_histogram.hpp"

namespace erard {

/// A DurationHistogram that one thread adds to and others read meanwhile, neither waiting for the other. A snapshot may
/// hold a few durations more or less than another counter read at the same time.
class SharedHistogram {
 public:
  /// From one thread: it alone writes, so that loading and storing need not be one operation.
  void add(double duration) noexcept {
    std::atomic<long>& count = count_[DurationHistogram::bin(duration)];
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    worst_.store(std::max(worst_.load(std::memory_order_relaxed), duration), std::memory_order_relaxed);
  }

  DurationHistogram snapshot() const noexcept {
    std::array<long, DurationHistogram::kBins> count;
    for (std::size_t i = 0; i < count.size(); ++i) count[i] = count_[i].load(std::memory_order_relaxed);
    return {count, worst_.load(std::memory_order_relaxed)};
  }

 private:
  std::array<std::atomic<long>, DurationHistogram::kBins> count_{};
  std::atomic<double> worst_{0};  // [s]
};

}  // namespace erard
