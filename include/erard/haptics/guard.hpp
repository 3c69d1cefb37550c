// The gate that every force passes: finite, limited, never quicker than allowed, faded where it is not to be trusted.
#pragma once

#include <algorithm>
#include <cmath>

#include "erard/haptics/fault.hpp"

namespace erard {

struct GuardSettings {
  double max_force = 20;    // [N] of either sign
  double max_slew = 2e4;    // [N/s]
  double fade_time = 0.02;  // from all to nothing and back [s]
};

/// Force of one key on its way out.
///   fade  goes to 1 while all is well, to 0 while it is not, by T / fade_time a period
///   out   goes to fade * clamp(wanted, max_force), by max_slew T a period at most
/// A wanted force that is not finite counts as the last one that was, and as not well.
class Guard {
 public:
  /// @param wanted   [N]
  /// @param is_well  input and simulation are to be trusted
  /// @return force out [N], always finite, |force| <= max_force
  double pass(const GuardSettings& settings, double period, double wanted, bool is_well, Fault& faults) noexcept {
    if (std::isfinite(wanted)) {
      wanted_ = wanted;
    } else {
      faults |= Fault::step_not_finite;
      is_well = false;
    }
    const double step = period / settings.fade_time;
    fade_ = is_well ? std::min(1.0, fade_ + step) : std::max(0.0, fade_ - step);
    const double limited = std::clamp(wanted_, -settings.max_force, settings.max_force);
    if (limited != wanted_) faults |= Fault::force_limited;
    const double change = fade_ * limited - force_, most = settings.max_slew * period;
    if (std::abs(change) > most) {
      faults |= Fault::slew_limited;
      force_ += std::copysign(most, change);
    } else {
      force_ = fade_ * limited;
    }
    return force_;
  }

  /// The device has let go by itself: the force begins at zero again.
  void let_go() noexcept { force_ = fade_ = 0; }

  double force() const noexcept { return force_; }  // [N]
  double fade() const noexcept { return fade_; }    // 0 .. 1

 private:
  double wanted_ = 0, force_ = 0, fade_ = 0;
};

}  // namespace erard
