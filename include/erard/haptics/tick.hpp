// One period of the host: input in, force out.
#pragma once

#include "erard/haptics/finger.hpp"
#include "erard/solver/step.hpp"

namespace erard {

/// Longest internal step by default [s]: four steps at 2 kHz leave 0.2 to 0.4 % of error in the finger force where one
/// leaves 1.5 (piano) and 5 % (forte); docs/accuracy.md.
inline constexpr double kDefaultStep = 1.25e-4;

/// How a host drives the engine.
struct TickSettings {
  DriveKind drive = DriveKind::piston;
  double period = 5e-4;  // of the output, 2 kHz [s]
  int substeps = 4;      // internal steps a period
  Scheme scheme;         // its time_step is period / substeps: set all three by set_rate()

  /// @param internal_steps  a period; 0: as few as keep the internal step at kDefaultStep or below
  void set_rate(double rate_Hz, int internal_steps = 0) noexcept {
    period = 1 / rate_Hz;
    substeps = internal_steps > 0 ? internal_steps : static_cast<int>(std::ceil(period / kDefaultStep - 1e-9));
    scheme.time_step = period / substeps;
  }
};

struct TickReport {
  double force = 0;                           // of the finger at the end of the period [N]
  StepStatus status = StepStatus::converged;  // the worst of its steps
  int linearisations = 0;
  int sweeps = 0;
};

/// Force of the finger at the end of a step: at the instant where a law gives it, else the mean over the step.
inline double end_force(const Mechanism& mechanism, const Drive& drive, const State& state,
                        const StepReport& report) noexcept {
  if (drive.kind == DriveKind::piston) return piston_force(mechanism.model, state, drive.to);
  return drive.kind == DriveKind::force ? drive.to.value : report.finger_force;
}

/// Advances the mechanism by one period.
/// @param input     its at(time) gives the DriveSample of any instant of the period, noexcept
/// @param observer  called as observer(state, report, force) after each internal step, noexcept
/// A step that is not finite leaves the state as it was and ends the period.
template <typename Input, typename Observer>
TickReport tick(const Mechanism& mechanism, const TickSettings& settings, const Input& input, State& state,
                Workspace& work, Observer&& observer) noexcept {
  TickReport report;
  Drive drive{settings.drive, {}, input.at(state.time)};
  const double start = state.time;
  for (int i = 1; i <= settings.substeps; ++i) {
    drive.from = drive.to;
    drive.to = input.at(start + i * settings.scheme.time_step);
    const StepReport stepped = step(mechanism, settings.scheme, drive, state, work);
    report.status = std::max(report.status, stepped.status);
    if (stepped.status == StepStatus::not_finite) break;
    report.linearisations += stepped.linearisations;
    report.sweeps += stepped.sweeps;
    report.force = end_force(mechanism, drive, state, stepped);
    observer(state, stepped, report.force);
  }
  return report;
}

}  // namespace erard
