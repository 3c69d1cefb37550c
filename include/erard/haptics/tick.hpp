// One period of the host: input in, force out.
#pragma once

#include <limits>

#include "erard/haptics/finger.hpp"
#include "erard/solver/step.hpp"

namespace erard {

/// Internal steps by default: as long as this while nothing happens [s] ...
inline constexpr double kCalmStep = 2.5e-4;
/// ... and as short as this where the motion is not as guessed [s].
inline constexpr double kBusyStep = 6.25e-5;
/// What counts as not as guessed: the accelerations of the masses change by this in one step, rms [m/s^2]. Steps that
/// may be refused for that cost little more than fixed ones of 250 us and err less than fixed ones of 125:
/// docs/accuracy.md.
inline constexpr double kSurpriseLimit = 10;

/// How a host drives the engine.
struct TickSettings {
  DriveKind drive = DriveKind::piston;
  double period = 5e-4;  // of the output, 2 kHz [s]
  int substeps = 2;      // internal steps a period
  int refinement = 4;    // into so many shorter ones a step is split that its scheme refuses
  Scheme scheme;         // its time_step is period / substeps: set all of them by set_rate()

  TickSettings() noexcept { set_rate(2000); }

  /// @param internal_steps  a period, never split; 0: as few as keep them at kCalmStep, split down to kBusyStep
  void set_rate(double rate_Hz, int internal_steps = 0) noexcept {
    const auto count = [](double length, double step) noexcept {
      return static_cast<int>(std::ceil(length / step - 1e-9));
    };
    period = 1 / rate_Hz;
    substeps = internal_steps > 0 ? internal_steps : count(period, kCalmStep);
    scheme.time_step = period / substeps;
    refinement = internal_steps > 0 ? 1 : count(scheme.time_step, kBusyStep);
    scheme.surprise_limit = refinement > 1 ? kSurpriseLimit : std::numeric_limits<double>::infinity();
  }
};

struct TickReport {
  double force = 0;                           // of the finger at the end of the period [N]
  StepStatus status = StepStatus::converged;  // the worst of its steps
  int steps = 0;                              // internal, taken
  int linearisations = 0;
  int sweeps = 0;
};

/// Force of the finger at the end of a step: at the instant where a law gives it, else the mean over the step.
inline double end_force(const Mechanism& mechanism, const Drive& drive, const State& state,
                        const StepReport& report) noexcept {
  if (drive.kind == DriveKind::piston) return piston_force(mechanism.model, state, drive.to);
  return drive.kind == DriveKind::force ? drive.to.value : report.finger_force;
}

/// Enters a step into the report of its period. @return whether it was taken
/// @param next   drive of the step
/// @param drive  in: up to the start of the step; out: up to its end, when it was taken
inline bool enter_step(const Mechanism& mechanism, const Drive& next, const State& state, const StepReport& stepped,
                       Drive& drive, TickReport& report) noexcept {
  report.linearisations += stepped.linearisations;
  report.sweeps += stepped.sweeps;
  if (stepped.status == StepStatus::refused) return false;
  report.status = std::max(report.status, stepped.status);
  if (stepped.status == StepStatus::not_finite) return false;
  drive = next;
  ++report.steps;
  report.force = end_force(mechanism, drive, state, stepped);
  return true;
}

/// Advances the mechanism from the end of `drive` on, in `count` steps of the scheme, until one is not taken.
/// @param drive  in: up to the start; out: up to the end of the last step taken
template <typename Input, typename Observer>
StepStatus advance(const Mechanism& mechanism, const Scheme& scheme, int count, const Input& input, double start,
                   Drive& drive, State& state, Workspace& work, TickReport& report, Observer&& observer) noexcept {
  for (int i = 1; i <= count; ++i) {
    const Drive next{drive.kind, drive.to, input.at(start + i * scheme.time_step)};
    const StepReport stepped = step(mechanism, scheme, next, state, work);
    if (!enter_step(mechanism, next, state, stepped, drive, report)) return stepped.status;
    observer(state, stepped, report.force);
  }
  return StepStatus::converged;
}

/// The shorter steps into which one is split that was refused.
inline Scheme busy_scheme(const TickSettings& settings) noexcept {
  Scheme busy = settings.scheme;
  busy.time_step /= settings.refinement;
  busy.surprise_limit = std::numeric_limits<double>::infinity();
  return busy;
}

/// Advances the mechanism by one period.
/// @param input     its at(time) gives the DriveSample of any instant of the period, noexcept
/// @param observer  called as observer(state, report, force) after each internal step, noexcept
/// A step that is not finite leaves the state as it was and ends the period. At most substeps (1 + refinement) steps.
template <typename Input, typename Observer>
TickReport tick(const Mechanism& mechanism, const TickSettings& settings, const Input& input, State& state,
                Workspace& work, Observer&& observer) noexcept {
  TickReport report;
  Drive drive{settings.drive, {}, input.at(state.time)};
  const Scheme busy = busy_scheme(settings);
  const double start = state.time;
  for (int i = 0; i < settings.substeps && report.status != StepStatus::not_finite; ++i) {
    const double from = start + i * settings.scheme.time_step;
    const StepStatus taken = advance(mechanism, settings.scheme, 1, input, from, drive, state, work, report, observer);
    if (taken == StepStatus::refused)
      advance(mechanism, busy, settings.refinement, input, from, drive, state, work, report, observer);
  }
  return report;
}

}  // namespace erard
