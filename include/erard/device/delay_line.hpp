// What something was a fixed number of steps ago.
#pragma once

#include <cstddef>
#include <vector>

namespace erard {

/// Exact: the value pushed n steps ago, bit for bit; what it was filled with before that.
class DelayLine {
 public:
  /// @param steps  n >= 0; memory for n + 1 values, taken once
  explicit DelayLine(int steps, double value = 0) : value_(static_cast<std::size_t>(steps) + 1, value) {}

  /// @return the value pushed n steps ago, counting this push: n = 0 gives `value` back
  double push(double value) noexcept {
    value_[next_] = value;
    next_ = (next_ + 1) % value_.size();
    return value_[next_];
  }

  /// What the last push returned.
  double oldest() const noexcept { return value_[next_]; }

 private:
  std::vector<double> value_;
  std::size_t next_ = 0;
};

}  // namespace erard
