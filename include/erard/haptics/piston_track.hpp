// From the samples of one key to the piston that drives its action: where it is and how fast, in every period.
#pragma once

#include <algorithm>
#include <cmath>

#include "erard/haptics/position_watch.hpp"
#include "erard/haptics/rate_estimator.hpp"
#include "erard/solver/drive.hpp"

namespace erard {

struct PistonTrackSettings {
  RateEstimatorSettings estimator;
  double extrapolation = 0.001;  // a missing sample is guessed for so long, then the piston stands [s]
  double realign_speed = 0.02;   // of the piston, to where the key is after a silence or a jump, at most [m/s]
  double realign_time = 0.02;    // and in which the rest of the way falls to 1/e [s]
  double still_zone = 3e-4;      // a key whose samples stay within it may stand: six times the rms noise [m]
  double still_time = 0.05;      // when it has done so for so long [s]
};

/// Piston of one key,   Y = x + offset,   Y' = x' + offset'
///
/// - A sample that is missing is guessed, x += T x', for `extrapolation`; then x stands with rate zero.
/// - After that, after a jump, and at the very first, x begins anew where the key is, and the offset takes the
///   difference: Y is continuous whatever the samples do. The offset then closes,
///       offset' = -offset / realign_time,   at most realign_speed
///   once the force has faded: no force is felt that is not that of the key where it is.
/// - Samples that were lost on the way but counted (`lost`) are put between, so that the estimator, which knows
///   samples, not times, sees the true rate.
/// - A key that stands still but for its sensor's noise has a piston that stands still to the bit. Then its action
///   comes to rest and sleeps, Keyboard. Its samples stay within still_zone z of their mean, and so that a slow key does
///   not count as one that stands, their fading mean s = (31 s + x) / 32, whose noise is an eighth, within z / 8. When
///   it moves again the offset takes the difference, but for what would count as not aligned: that is a step of less
///   than z and a sample.
class PistonTrack {
 public:
  PistonTrack(const PistonTrackSettings& settings, double period) noexcept : estimator_(settings.estimator, period) {}

  /// A sample that counts. @param position [m], @param lost samples before it, @param resumed it may lie anywhere
  void take(const PistonTrackSettings& settings, double period, double position, int lost, bool resumed) noexcept {
    smooth_ += resumed ? position - smooth_ : kFresh * (position - smooth_);
    if (is_still_ && is_near(settings, position, middle_)) {
      missed_ = 0;
      return;
    }
    const bool has_stood = is_still_ && !resumed;
    if (resumed || is_still_ || is_guessed_out(settings, period)) {
      begin(position);
      if (has_stood) offset_ = std::clamp(offset_, -kAligned / 2, kAligned / 2);
    } else {
      const int between = std::clamp(lost - missed_, 0, kMostBetween);
      for (int i = 1; i <= between; ++i) estimator_.update(x_ + (position - x_) * i / (between + 1));
      rate_ = estimator_.update(position);
      x_ = position;
    }
    missed_ = 0;
    look_for_stillness(settings, period);
  }

  /// No sample that counts in this period.
  void miss(const PistonTrackSettings& settings, double period) noexcept {
    if (missed_ < kLong) ++missed_;
    if (is_still_) return;
    if (!is_guessed_out(settings, period)) {
      x_ += period * rate_;
      estimator_.update(x_);
    } else {
      rate_ = 0;
    }
  }

  /// The piston at the end of the period. @param is_force_off  none is felt: it may go to where the key is
  /// @return [m], [m/s]
  DriveSample advance(const PistonTrackSettings& settings, double period, bool is_force_off) noexcept {
    if (is_still_ && piston_.rate == 0) return piston_;
    const double most = is_aligned() || is_force_off ? settings.realign_speed * period : 0;
    const double closed = std::clamp(offset_ * std::min(period / settings.realign_time, 1.0), -most, most);
    offset_ -= std::abs(offset_) < kNothing ? offset_ : closed;
    piston_ = {x_ + offset_, is_still_ ? 0 : rate_ - closed / period};
    return piston_;
  }

  const DriveSample& piston() const noexcept { return piston_; }
  bool is_still() const noexcept { return is_still_; }
  /// Whether the piston is where the key is.
  bool is_aligned() const noexcept { return std::abs(offset_) <= kAligned; }

 private:
  static constexpr int kMostBetween = 8;                    // more and the estimator has forgotten anyway
  static constexpr int kLong = 1 << 20;                     // periods
  static constexpr double kAligned = 1e-4;                  // [m] 0.65 N of the thesis's finger
  static constexpr double kNothing = 1e-9;                  // [m] a thousandth of what sensors resolve
  static constexpr double kFresh = 1.0 / 32, kQuieter = 8;  // of s; its noise: sqrt(kFresh / (2 - kFresh)) = 1 / 7.9

  bool is_guessed_out(const PistonTrackSettings& settings, double period) const noexcept {
    return missed_ * period > settings.extrapolation * (1 + 1e-9);  // whole periods, whatever the rounding
  }

  bool is_near(const PistonTrackSettings& settings, double position, double middle) const noexcept {
    return std::abs(position - middle) <= settings.still_zone &&
           std::abs(smooth_ - middle) <= settings.still_zone / kQuieter;
  }

  void begin(double position) noexcept {
    estimator_.reset(position);
    x_ = position;
    rate_ = 0;
    offset_ = piston_.value - position;
    is_still_ = false;
    sum_ = 0;
    count_ = 0;
  }

  /// Whether all samples for still_time lay around their running mean.
  void look_for_stillness(const PistonTrackSettings& settings, double period) noexcept {
    if (count_ > 0 && !is_near(settings, x_, sum_ / count_)) sum_ = 0, count_ = 0;
    sum_ += x_;
    ++count_;
    if (count_ * period < settings.still_time || std::abs(offset_) > settings.still_zone / (kQuieter * kQuieter))
      return;
    is_still_ = true;
    middle_ = sum_ / count_;
    x_ = middle_;
  }

  double middle_ = 0;  // of the samples of a key that stands still [m]
  bool is_still_ = false;
  int missed_ = 0;                        // periods since the last sample that counted
  DriveSample piston_;                    // now
  double x_ = 0, rate_ = 0, offset_ = 0;  // [m], [m/s], [m]
  double smooth_ = 0;                     // s [m]
  double sum_ = 0;                        // of samples [m]
  int count_ = 0;
  RateEstimator estimator_;
};

}  // namespace erard
