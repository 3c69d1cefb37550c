// How long something takes, over and over: quantiles from a fixed amount of memory.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace erard {

/// Counts of durations in bins of 1 % width from 10 ns to 10 s; shorter and longer ones go to the first and the last bin.
class DurationHistogram {
 public:
  static constexpr std::size_t kBins = 2083;  // to 10 s

  DurationHistogram() = default;
  DurationHistogram(const std::array<long, kBins>& count, double worst) noexcept : count_(count), worst_(worst) {
    for (const long each : count_) total_ += each;
  }

  /// Bin of a duration [s].
  static std::size_t bin(double duration) noexcept {
    const double bin = std::log(std::max(duration, kShortest) / kShortest) / kLogWidth;
    return static_cast<std::size_t>(std::min(bin, static_cast<double>(kBins - 1)));
  }

  void add(double duration) noexcept {
    ++count_[bin(duration)];
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
  /// How many fall into bin i, and the shortest duration of it [s]; bin 0 has all that are shorter.
  long count(std::size_t i) const noexcept { return count_[i]; }
  static double lower_edge(std::size_t i) noexcept { return kShortest * std::exp(kLogWidth * static_cast<double>(i)); }

  double worst() const noexcept { return worst_; }  // [s]
  long total() const noexcept { return total_; }

 private:
  static constexpr double kShortest = 1e-8;                 // [s]
  static constexpr double kLogWidth = 0.00995033085316808;  // ln 1.01
  std::array<long, kBins> count_{};
  long total_ = 0;
  double worst_ = 0;
};

}  // namespace erard
