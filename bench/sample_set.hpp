// Where timings go while the clock runs: memory that is there before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/contender.hpp"

namespace erard::bench {

/// Timings of one contender [s], clock subtracted. Memory is touched when it is made: no page is asked for later.
class SampleSet {
 public:
  /// @param ticks  most periods it can hold
  /// @param steps_a_tick  whose times are kept as well; 0: none
  SampleSet(std::size_t ticks, int steps_a_tick)
      : tick_(ticks, 0.0), step_(ticks * static_cast<std::size_t>(steps_a_tick), 0.0), noise_(ticks, 0.0) {}

  std::size_t room() const noexcept { return tick_.size() - count_; }  // [ticks]

  /// Room must be left. All times [ns], clock included.
  /// @param step_ends  of the steps of this period, as many as are kept
  void add(std::int64_t begin, std::span<const std::int64_t> step_ends, std::int64_t end, std::int64_t work_begin,
           std::int64_t work_end, std::int64_t clock) noexcept {
    constexpr double kNano = 1e-9;
    const auto looks = static_cast<std::int64_t>(step_ends.size()) + 1;
    tick_[count_] = kNano * static_cast<double>(end - begin - looks * clock);
    noise_[count_] = kNano * static_cast<double>(work_end - work_begin - clock);
    ++count_;
    std::int64_t from = begin;
    for (const std::int64_t to : step_ends) {
      step_[step_count_++] = kNano * static_cast<double>(to - from - clock);
      from = to;
    }
  }

  void add(const Effort& effort) noexcept { effort_ += effort; }

  /// Only the first `ticks` stay: a slice that was broken off is not a fair sample of its scene.
  void cut_back(std::size_t ticks) noexcept {
    if (count_ > 0) step_count_ = step_count_ / count_ * ticks;
    count_ = ticks;
  }

  std::span<double> ticks() { return std::span(tick_).first(count_); }
  std::span<double> steps() { return std::span(step_).first(step_count_); }
  std::span<double> noise() { return std::span(noise_).first(count_); }
  const Effort& effort() const { return effort_; }

 private:
  std::vector<double> tick_, step_, noise_;
  std::size_t count_ = 0, step_count_ = 0;
  Effort effort_;
};

}  // namespace erard::bench
