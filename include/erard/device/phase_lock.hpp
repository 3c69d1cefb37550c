// Keeps a loop at a fixed delay behind another clock of the same rate, or nearly the same.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace erard {

struct PhaseLockSettings {
  std::int64_t period_ns = 500'000;  // of both
  std::int64_t delay_ns = 150'000;   // of the loop's grid point after the other's, 0 <= delay < period
  double gain = 1.0 / 64;            // share of the error taken back each period: averages over 32 ms at 2 kHz
  std::int64_t max_slew_ns = 1000;   // each period: 250 us, the worst error, are gone after 250 periods
};

/// A proportional loop with bounded slew:
///   e = wrap(due - (observed + delay)) into [-T/2, T/2),   shift = -clamp(gain e, -max_slew, max_slew)
/// Against a clock that drifts by 20 ppm the error settles at 20e-6 T / gain, 0.6 us at 2 kHz. A single late arrival
/// moves the grid by max_slew at most. Pure arithmetic: no state but the settings.
class PhaseLock {
 public:
  explicit PhaseLock(const PhaseLockSettings& settings) noexcept : settings_(settings) {}

  /// How far the loop is behind (positive) where it should be [ns].
  /// @param due       a grid point of the loop [ns]
  /// @param observed  an instant of the other clock, on the same time scale [ns]: the device's time where it is shared,
  ///                  else when its message arrived
  std::int64_t error(std::int64_t due, std::int64_t observed) const noexcept {
    const std::int64_t period = settings_.period_ns;
    const std::int64_t rest = (due - observed - settings_.delay_ns) % period;  // in (-T, T)
    if (rest >= (period + 1) / 2) return rest - period;
    return rest < -(period / 2) ? rest + period : rest;
  }

  /// What to move the grid by, for PeriodicLoop::shift() [ns].
  std::int64_t shift(std::int64_t due, std::int64_t observed) const noexcept {
    return correction(error(due, observed));
  }

  /// The same for a grid point that belongs to just this instant of the other clock, however far away: e = due -
  /// (observed + delay).
  std::int64_t shift_onto(std::int64_t due, std::int64_t observed) const noexcept {
    return correction(due - observed - settings_.delay_ns);
  }

 private:
  std::int64_t correction(std::int64_t error) const noexcept {
    const auto wanted = std::llround(settings_.gain * static_cast<double>(error));
    return -std::clamp<std::int64_t>(wanted, -settings_.max_slew_ns, settings_.max_slew_ns);
  }

  PhaseLockSettings settings_;
};

}  // namespace erard
