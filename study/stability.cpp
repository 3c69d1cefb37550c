#include "study/stability.hpp"

#include <algorithm>
#include <cmath>

namespace erard::study {
namespace {

constexpr FingerSettings kHand{1000, 5};  // in the simulated maps

LoopCase case_of(double lever_mass, int delay, const FingerSettings& finger) {
  LoopCase loop;
  loop.lever_mass = lever_mass;
  loop.finger = finger;
  loop.delay_periods = delay;
  loop.actuator_lag = kCoilLag;
  return loop;
}

/// For the maps: nothing but the loop.
ClosedLoopSettings bare_loop(const LoopSetting& setting, double lever_mass, int delay) {
  ClosedLoopSettings loop = loop_of(setting, lever_mass, delay, kHand);
  loop.rig.lever.dry_friction = 0;
  loop.rig.lever.depth = 0.1;  // 20 N through 700 N/m are 29 mm: a lever on its stop cannot shake
  loop.rig.sensor.noise = 2e-6;
  return loop;
}

bool is_quiet(const LoopTrace& trace) {
  constexpr double kLoud = 5;  // [N] noise of 2 um gives a tenth of it, a limit cycle several times as much
  const HoldVerdict verdict = judge_hold(trace);
  return verdict.last < kLoud && !verdict.grows();
}

}  // namespace

LoopSetting plain_setting() {
  return {"backward difference", [](double, int) { return SlidingPolynomial(kPeriod, 2, 1); }, {6500, 134}};
}
LoopSetting cautious_setting() {
  return {"parabola of 6 samples", [](double, int) { return SlidingPolynomial(kPeriod, 6, 2); }, {4000, 9}};
}
LoopSetting observed_setting() {
  const auto observer = [](double lever_mass, int delay) {
    return LeverObserver({lever_mass, 0.85, delay, kCoilLag, 0}, kPeriod);
  };
  return {"lever observer, memory 0.85", observer, {6500, 90}};
}
LoopSetting with_coupling(LoopSetting setting, const Coupling& coupling) {
  setting.coupling = coupling;
  return setting;
}

double least_margin(const LoopSetting& setting, double lever_mass, int delay, std::span<const FingerSettings> fingers) {
  double least = HUGE_VAL;
  for (const FingerSettings& finger : fingers) {
    const CouplingLoop loop(case_of(lever_mass, delay, finger), kPeriod, setting.estimator(lever_mass, delay));
    least = std::min(least, loop.gain_margin(setting.coupling));
  }
  return least;
}

double least_margin_on_masses(const LoopSetting& setting, double lever_mass, int delay) {
  double least = HUGE_VAL;
  for (const FingerSettings& finger : kFingers)
    for (const double mass : {0.02, 0.06, 0.15}) {
      LoopCase loop = case_of(lever_mass, delay, finger);
      loop.virtual_mass = mass;
      const CouplingLoop linear(loop, kPeriod, setting.estimator(lever_mass, delay));
      least = std::min(least, linear.gain_margin(setting.coupling));
    }
  return least;
}

double least_margin_misled(const LoopSetting& setting, double lever_mass, int delay, double told_mass, int told_delay) {
  double least = HUGE_VAL;
  for (const FingerSettings& finger : kFingers) {
    const CouplingLoop loop(case_of(lever_mass, delay, finger), kPeriod, setting.estimator(told_mass, told_delay));
    least = std::min(least, loop.gain_margin(setting.coupling));
  }
  return least;
}

double noise_force(const LoopSetting& setting, double lever_mass, int delay, double noise) {
  double largest = 0;
  for (const FingerSettings& finger : kFingers) {
    const CouplingLoop loop(case_of(lever_mass, delay, finger), kPeriod, setting.estimator(lever_mass, delay));
    largest = std::max(largest, noise * loop.noise_gain(setting.coupling));
  }
  return largest;
}

ClosedLoopSettings loop_of(const LoopSetting& setting, double lever_mass, int delay, const FingerSettings& finger) {
  ClosedLoopSettings loop;
  loop.rig.lever.mass = lever_mass;
  loop.rig.lever.depth = 0.025;  // deep enough that 20 N through the softest coupling do not reach it
  loop.rig.finger = finger;
  loop.rig.sensor.noise = kNoise;
  loop.rig.actuator.time_constant = kCoilLag;
  loop.delay_periods = delay;
  loop.period = kPeriod;
  loop.host = PlainHost{setting.estimator(lever_mass, delay), setting.coupling};
  return loop;
}

ClosedLoopSettings pipeline_loop(const RenderSettings& device, ActuatorKind actuator, double lever_mass, int delay,
                                 const FingerSettings& finger) {
  ClosedLoopSettings loop = loop_of(cautious_setting(), lever_mass, delay, finger);
  RenderSettings rendering = device;
  rendering.watch.highest = loop.rig.lever.depth + 1e-3;
  rendering.track.still_zone = 0;
  rendering.actuator.kind = actuator;
  rendering.actuator.voice_coil.continuous_current = rendering.actuator.voice_coil.max_current;
  if (actuator == ActuatorKind::mr_brake) {
    loop.rig.actuator = VirtualActuatorSettings::mr_brake();
    loop.rig.actuator.off_drag = rendering.actuator.mr_brake.drag;
  }
  loop.host = PipelineHost{rendering};
  return loop;
}

ActionFile with_rigid_key(ActionFile action) {
  action.model.bodies[static_cast<std::size_t>(action.model.finger.body)].is_held = true;
  return action;
}

bool is_quiet_on_rigid_key(const ActionFile& rigid, const LoopSetting& setting, double lever_mass, int delay) {
  constexpr double kForce = 20;  // [N] far from lifting off
  const ClosedLoopSettings loop = bare_loop(setting, lever_mass, delay);
  const HoldPoint point{kForce / setting.coupling.stiffness, kForce};
  return is_quiet(play_loop(rigid, loop, hold_with(kHand, point, 3)));
}

bool is_quiet_on_bottom(const ActionFile& action, const LoopSetting& setting, double lever_mass, int delay) {
  const ClosedLoopSettings loop = bare_loop(setting, lever_mass, delay);
  const HoldPoint point = hold_point(action, setting.coupling, Hold::firm_bottom);
  return is_quiet(play_loop(action, loop, hold_with(kHand, point, 3)));
}

}  // namespace erard::study
