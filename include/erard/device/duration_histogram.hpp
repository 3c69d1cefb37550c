// How long something takes, over and over: quantiles from a fixed amount of memory.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace erard {

/// Counts of durations in bins of 1 % width from 10 ns to 10 s; shorter and longer ones go to the first and the last bin.
class DurationHistogram {
 public:
  void add(double duration) noexcept {
    const double bin = std::log(std::max(duration, kShortest) / kShortest) / kLogWidth;
    ++count_[static_cast<std::size_t>(std::min(bin, kBins - 1.0))];
    ++total_;
    worst_ = std::max(worst_, duration);
  }

  /// Duration that a share q of all does not exceed [s], to 1 %; 0 when there is none.
  double quantile(double q) const noexcept {
    long seen = 0;
    for (std::size_t i = 0; i < count_.size(); ++i) {
      seen += count_[i];
      if (seen > 0 && static_cast<double>(seen) >= q * static_cast<double>(total_))
        return std::min(worst_, kShortest * std::exp(kLogWidth * (static_cast<double>(i) + 1)));
    }
    return 0;
  }
  double worst() const noexcept { return worst_; }  // [s]

 private:
  static constexpr double kShortest = 1e-8;                 // [s]
  static constexpr double kLogWidth = 0.00995033085316808;  // ln 1.01
  static constexpr int kBins = 2083;                        // to 10 s
  std::array<long, kBins> count_{};
  long total_ = 0;
  double worst_ = 0;
};

}  // namespace erard
