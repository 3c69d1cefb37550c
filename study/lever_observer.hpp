// Where a device's lever is and how fast, from its samples and from the force that the device itself puts on it.
//
// An estimator that sees positions alone finds out about the device's own force late, through the motion that it has
// made; a coupling that damps with such a rate destabilises what it should calm (docs/stability.md). But that force is
// known. What is not known is the finger's, which changes with the speed of muscles and of skin:
//   m y'' = m w - f        w: what all the rest does to the lever [m/s^2], f: own force, up positive [N]
//   f' = (u - f) / tau     u: the command that has arrived
// With each sample
//   y, y', f  go on by a period T under the command of n periods ago, w stays
//   miss = sample - y:   y += alpha miss,  y' += beta/T miss,  w += 2 gamma/T^2 miss
// with the gains of FadingPolynomial (degree 2): least squares over all the past, each sample counting by memory^age.
// The piston is then led ahead by what is on its way: the commands of the n periods in which a new one will not act yet,
// and `lead`, half a period for one that will be held for a period.
//
// Compared in docs/stability.md and not part of the host's pipeline: it has to be told lever and delay, and a rigid stop is
// no free lever. For a voice coil. A brake's force is not its command while the lever sticks, and needs no such help: it cannot push.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "erard/solver/drive.hpp"

namespace erard::study {

struct LeverObserverSettings {
  // m, effective at the finger; told a quarter too heavy it costs a quarter of the margin [kg] > 0
  double lever_mass = 0.1;
  double memory = 0.7;         // q, 0 <= q < 1
  int delay_periods = 1;       // n, between a sample and its force, 0 .. kMaxDelay
  double actuator_lag = 3e-4;  // tau [s] >= 0
  double lead = 2.5e-4;        // beyond the delay [s]
};

/// A dozen operations for each period of delay. No heap, no exception.
class LeverObserver {
 public:
  static constexpr int kMaxDelay = 8;

  /// @param period  T [s] > 0
  LeverObserver(const LeverObserverSettings& settings, double period) noexcept
      : settings_(settings), period_(period), delay_(std::clamp(settings.delay_periods, 0, kMaxDelay)) {
    const double q = settings.memory;
    alpha_ = 1 - q * q * q;
    beta_ = 1.5 * (1 - q) * (1 - q) * (1 + q) / period;
    gamma_ = (1 - q) * (1 - q) * (1 - q) / (period * period);
    const double ratio = settings.actuator_lag > 0 ? period / settings.actuator_lag : HUGE_VAL;
    kept_ = std::exp(-ratio);
    kept_in_mean_ = std::isinf(ratio) ? 0 : -std::expm1(-ratio) / ratio;
  }

  /// Has always been at rest there, without a command.
  void reset(double position) noexcept {
    now_ = {position, 0, 0};
    unknown_ = 0;
    command_.fill(0);
    is_empty_ = false;
  }

  /// Takes the sample of now [m]. @return piston position [m] and rate [m/s] for when the next command will act.
  DriveSample update(double position) noexcept {
    if (is_empty_) reset(position);
    const double miss = position - now_.position;
    now_.position += alpha_ * miss;
    now_.rate += beta_ * miss;
    unknown_ += gamma_ * miss;
    Estimate then = now_;
    for (int i = delay_; i > 0; --i) go_on(then, command_[i - 1]);
    const double lead = settings_.lead, acceleration = unknown_ - then.force / settings_.lever_mass;
    return {then.position + lead * then.rate + lead * lead / 2 * acceleration, then.rate + lead * acceleration};
  }

  /// Tells what was commanded in answer to the last sample: the force that will lift the lever, as it passed all limits [N].
  void sent(double command) noexcept {
    std::copy_backward(command_.begin(), command_.end() - 1, command_.end());
    command_[0] = command;
    go_on(now_, command_[delay_]);
  }

  /// The acceleration of the lever that its own force does not explain [m/s^2].
  double unknown() const noexcept { return unknown_; }

 private:
  struct Estimate {
    double position = 0, rate = 0, force = 0;  // [m], [m/s], [N]
  };

  /// A period under a command.
  void go_on(Estimate& estimate, double command) const noexcept {
    const double mean = command + kept_in_mean_ * (estimate.force - command);
    const double acceleration = unknown_ - mean / settings_.lever_mass;
    estimate.position += period_ * estimate.rate + period_ * period_ / 2 * acceleration;
    estimate.rate += period_ * acceleration;
    estimate.force = command + kept_ * (estimate.force - command);
  }

  LeverObserverSettings settings_;
  double period_;
  int delay_;
  double alpha_ = 0, beta_ = 0, gamma_ = 0;      // [-], [1/s], [1/s^2]
  double kept_ = 0, kept_in_mean_ = 0;           // shares of the force before
  Estimate now_;                                 // at the next sample, once the last command was told
  double unknown_ = 0;                           // w [m/s^2]
  std::array<double, kMaxDelay + 1> command_{};  // the newest first [N]
  bool is_empty_ = true;
};

}  // namespace erard::study
