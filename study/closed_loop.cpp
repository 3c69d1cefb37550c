#include "study/closed_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "erard/device/intended_motion.hpp"
#include "erard/device/simulation.hpp"
#include "erard/haptics/keyboard.hpp"
#include "erard/mechanics/rest.hpp"
#include "study/defaults.hpp"

namespace erard::study {
namespace {

/// The simulated side of the loop: samples in, forces out.
class Rendering {
 public:
  Rendering(const ActionFile& action, const ClosedLoopSettings& settings)
      : estimator_(settings.estimator),
        mechanism_(build_mechanism(with(action.model, settings.coupling))),
        detector_(mechanism_, action.roles),
        work_(std::make_unique<Workspace>()) {
    tick_.set_rate(1 / settings.period);
    state_ = rest_state(mechanism_, tick_.scheme.time_step);
  }

  /// @return the force at the end of the period that begins with this sample, were it simulated to its end [N]
  double answer(double sample) {
    const DriveSample piston = estimator_.update(sample);
    const LineInput line{last_, piston, state_.time, tick_.period};
    const auto observe = [this](const State& now, const StepReport&, double force) noexcept {
      detector_.observe(now, force);
    };
    const TickReport report = tick(mechanism_, tick_, line, state_, *work_, observe);
    if (report.status == StepStatus::not_finite) throw std::runtime_error("closed loop: a step that is not finite");
    last_ = piston;
    return report.force;
  }
  void sent(double command) { estimator_.sent(command); }

  double key() const { return key_position(mechanism_.model, state_); }
  double hammer_speed() const {
    for (int i = 0; i < detector_.count(); ++i)
      if (detector_[i].kind == EventKind::hammer_meets_string) return detector_[i].hammer_speed;
    return 0;
  }

 private:
  static Model with(Model model, const Coupling& coupling) {
    model.finger.stiffness = coupling.stiffness;
    model.finger.damping = coupling.damping;
    return model;
  }

  PistonEstimator estimator_;
  Mechanism mechanism_;
  EventDetector detector_;
  std::unique_ptr<Workspace> work_;
  TickSettings tick_;
  State state_;
  DriveSample last_;
};

/// What a brake is asked for: nothing while the lever rises, since it would hold it back.
class BrakeRelease {
 public:
  explicit BrakeRelease(const ClosedLoopSettings& settings)
      : is_brake_(settings.rig.actuator.kind == VirtualActuatorKind::mr_brake),
        speed_(settings.release_speed),
        rate_(settings.period, kMemory, 1) {}

  double command(double force, double sample) {
    if (!is_brake_) return force;
    return rate_.update(sample) < -speed_ ? 0 : force;
  }

 private:
  static constexpr double kMemory = 0.85;  // 6 ms of delay, 4 mm/s of noise for 50 um

  bool is_brake_;
  double speed_;
  FadingPolynomial rate_;
};

/// Second-order high pass at 50 Hz, bilinear. A fourth-order Butterworth filter is two of them, with their own Q.
class HighPass {
 public:
  HighPass(double period, double quality) {
    const double w = std::tan(std::numbers::pi * 50 * period), scale = 1 / (1 + w / quality + w * w);
    gain_ = scale;
    back_1_ = 2 * (w * w - 1) * scale;
    back_2_ = (1 - w / quality + w * w) * scale;
  }
  double operator()(double x) {
    const double y = gain_ * (x - 2 * x_1_ + x_2_) - back_1_ * y_1_ - back_2_ * y_2_;
    x_2_ = x_1_, x_1_ = x, y_2_ = y_1_, y_1_ = y;
    return y;
  }

 private:
  double gain_ = 0, back_1_ = 0, back_2_ = 0;
  double x_1_ = 0, x_2_ = 0, y_1_ = 0, y_2_ = 0;
};

}  // namespace

ForceCurve LoopTrace::finger_curve(double start) const {
  ForceCurve curve;
  for (std::size_t i = 0; i < finger.size(); ++i) {
    curve.time.push_back(start + static_cast<double>(i + 1) * period);
    curve.force.push_back(finger[i]);
  }
  return curve;
}

LoopTrace play_loop(const ActionFile& action, const ClosedLoopSettings& settings, const Keystroke& intended) {
  Rendering rendering(action, settings);
  BrakeRelease release(settings);
  Rig rig(settings.rig, intended);
  std::deque<double> under_way(static_cast<std::size_t>(settings.delay_periods), 0.0);
  LoopTrace trace;
  trace.period = settings.period;
  const long periods = std::lround((intended.end() - intended.start()) / settings.period);
  for (long i = 0; i < periods; ++i) {
    const double sample = rig.measure();
    const double command = release.command(rendering.answer(sample), sample);
    rendering.sent(std::clamp(command, -settings.rig.actuator.limit, settings.rig.actuator.limit));
    under_way.push_back(command);
    rig.advance(settings.period, under_way.front());
    under_way.pop_front();
    trace.command.push_back(command);
    trace.finger.push_back(rig.state().finger_force);
    trace.lever.push_back(rig.state().lever.position);
    trace.key.push_back(rendering.key());
  }
  trace.hammer_speed = rendering.hammer_speed();
  return trace;
}

double rms_above_50_Hz(const std::vector<double>& signal, double period, double from, double until) {
  const double eighth = std::numbers::pi / 8;
  HighPass first(period, 0.5 / std::cos(eighth)), second(period, 0.5 / std::cos(3 * eighth));
  double sum = 0;
  long count = 0;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double high = second(first(signal[i])), time = static_cast<double>(i) * period;
    if (time < from || time >= until) continue;
    sum += high * high;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

const char* name_of(Hold hold) {
  switch (hold) {
    case Hold::at_rest: return "at rest";
    case Hold::at_let_off: return "at the let-off";
    case Hold::on_bottom: break;
  }
  return "on the key bottom";
}

HoldPoint hold_point(const ActionFile& action, const Coupling& coupling, Hold hold) {
  constexpr double kTouch = 0.3, kBottom = 5;           // [N] less than the 0.54 N that move the key; a firm hold
  constexpr double kSpeed = 0.01;                       // [m/s] of the press
  constexpr double kPastButton = 3e-4, kDeep = 9.3e-3;  // [m] on the way from the button to escapement; on the punching
  if (hold == Hold::at_rest) return {kTouch / coupling.stiffness, kTouch};
  ActionFile pressed = action;
  pressed.model.finger.stiffness = coupling.stiffness;
  pressed.model.finger.damping = coupling.damping;
  const Keystroke press(KeystrokeQuantity::position, {0, 0.1, 4}, {0, 0.1 * kSpeed, 4 * kSpeed});
  RunSettings run_settings;
  run_settings.start = 0;
  run_settings.duration = 4;
  HoldPoint found;
  double button = HUGE_VAL;
  const int let_off = action.roles.let_off;
  run_settings.on_row = [&](const Snapshot& row) {
    if (row.normal[static_cast<std::size_t>(let_off)] > 0) button = std::min(button, row.key_position);
    const bool is_there = hold == Hold::at_let_off ? row.key_position > button + kPastButton
                                                   : row.key_position > kDeep && row.force > kBottom;
    if (is_there && found.force == 0) found = {row.input.value, row.force};
  };
  run_settings.goes_on = [&](double) { return found.force == 0; };
  run(pressed, press, run_settings);
  if (found.force == 0) throw std::runtime_error(fmt::format("no point {} was found", name_of(hold)));
  return found;
}

Keystroke hold_with(const FingerSettings& finger, const HoldPoint& point, double seconds) {
  return press_and_hold(point.position + point.force / finger.stiffness, 0.1, 1, seconds);
}

HoldVerdict judge_hold(const LoopTrace& trace, double buzz) {
  const double end = static_cast<double>(trace.command.size()) * trace.period;
  HoldVerdict verdict;
  verdict.before = rms_above_50_Hz(trace.command, trace.period, end - 2, end - 1);
  verdict.last = rms_above_50_Hz(trace.command, trace.period, end - 1, end);
  verdict.finger = rms_above_50_Hz(trace.finger, trace.period, end - 1, end);
  constexpr double kSilence = 1e-6;  // [N] below it ratios say nothing
  verdict.is_stable = verdict.last <= kNoGrowth * verdict.before + kSilence && verdict.last <= buzz;
  return verdict;
}

HoldVerdict hold(const ActionFile& action, const ClosedLoopSettings& settings, Hold hold, double seconds, double buzz) {
  const HoldPoint point = hold_point(action, settings.coupling, hold);
  return judge_hold(play_loop(action, settings, hold_with(settings.rig.finger, point, seconds)), buzz);
}

ReferenceStroke reference_stroke(const ActionFile& action, const std::string& keystroke, double end) {
  const Keystroke piston = default_keystroke(keystroke);
  ReferenceStroke stroke;
  stroke.name = keystroke;
  stroke.end = end;
  RunSettings settings;
  settings.start = piston.start();
  settings.duration = piston.end() - piston.start();
  settings.on_row = [&stroke](const Snapshot& row) {
    stroke.force.time.push_back(row.time);
    stroke.force.force.push_back(row.force);
    stroke.key.push_back(row.key_position);
  };
  for (const Event& event : run(action, piston, settings).events)
    if (event.kind == EventKind::hammer_meets_string && stroke.hammer_speed == 0)
      stroke.hammer_speed = event.hammer_speed;
  return stroke;
}

Keystroke intended_by(const FingerSettings& finger, const ReferenceStroke& stroke) {
  // e = X - y:  e' = (F - k e) / d,  with F = F0 + s t exactly e = F / k - s d / k^2 + C exp(-k t / d)
  const double k = finger.stiffness, d = finger.damping;
  const std::vector<double>&t = stroke.force.time, &F = stroke.force.force;
  std::vector<double> intended{stroke.key[0] + F[0] / k};
  double e = F[0] / k;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    const double h = t[i + 1] - t[i], slope = (F[i + 1] - F[i]) / h, lag = slope * d / (k * k);
    e = F[i + 1] / k - lag + (e - F[i] / k + lag) * std::exp(-k * h / d);
    intended.push_back(stroke.key[i + 1] + e);
  }
  return {KeystrokeQuantity::position, t, intended};
}

Fidelity fidelity(const ActionFile& action, const ClosedLoopSettings& settings, const ReferenceStroke& stroke) {
  const Keystroke intended = intended_by(settings.rig.finger, stroke);
  const LoopTrace trace = play_loop(action, settings, intended);
  const ForceCurve felt = trace.finger_curve(intended.start());
  Fidelity result;
  result.eta = relative_error(stroke.force, felt, stroke.end);
  long count = 0;
  for (std::size_t i = 0; i < felt.time.size() && felt.time[i] <= stroke.end; ++i, ++count)
    result.rms += std::pow(felt.force[i] - stroke.force.force[i + 1], 2);
  result.rms = std::sqrt(result.rms / static_cast<double>(std::max(count, 1L)));
  result.hammer_speed = trace.hammer_speed / stroke.hammer_speed - 1;
  return result;
}

ActionFile without_lever_mass(const ActionFile& action, double lever_mass) {
  constexpr double kKept = 0.1;  // of the key's inertia
  ActionFile lighter = action;
  Body& key = lighter.model.bodies[static_cast<std::size_t>(lighter.model.finger.body)];
  const double arm = lighter.model.finger.arm;
  key.inertia = std::max(key.inertia - lever_mass * arm * arm, kKept * key.inertia);
  return lighter;
}

}  // namespace erard::study
