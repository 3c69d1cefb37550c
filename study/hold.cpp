#include "study/hold.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "erard/device/intended_motion.hpp"
#include "erard/device/simulation.hpp"

namespace erard::study {
namespace {

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
    case Hold::on_bottom: return "on the key bottom, 5 N";
    case Hold::firm_bottom: break;
  }
  return "on the key bottom, 15 N";
}

HoldPoint hold_point(const ActionFile& action, const Coupling& coupling, Hold hold) {
  constexpr double kTouch = 0.3;                        // [N] less than the 0.54 N that move the key
  constexpr double kSpeed = 0.01;                       // [m/s] of the press
  constexpr double kLongest = 4;                        // [s] of it
  constexpr double kPastButton = 3e-4, kDeep = 9.3e-3;  // [m] on the way from the button to escapement; on the punching
  if (hold == Hold::at_rest) return {kTouch / coupling.stiffness, kTouch};
  const double bottom_force = hold == Hold::firm_bottom ? 15 : 5;  // [N]
  ActionFile pressed = action;
  pressed.model.finger.stiffness = coupling.stiffness;
  pressed.model.finger.damping = coupling.damping;
  HoldPoint found;
  double button = HUGE_VAL;
  RunSettings settings;
  settings.duration = kLongest;
  settings.on_row = [&](const Snapshot& row) {
    if (row.normal[static_cast<std::size_t>(action.roles.let_off)] > 0) button = std::min(button, row.key_position);
    const bool is_there = hold == Hold::at_let_off ? row.key_position > button + kPastButton
                                                   : row.key_position > kDeep && row.force > bottom_force;
    if (is_there && found.force == 0) found = {row.input.value, row.force};
  };
  settings.goes_on = [&](double) { return found.force == 0; };
  run(pressed, {KeystrokeQuantity::position, {0, kLongest}, {0, kLongest * kSpeed}}, settings);
  if (found.force == 0) throw std::runtime_error(fmt::format("the action has no place {}", name_of(hold)));
  return found;
}

Keystroke hold_with(const FingerSettings& finger, const HoldPoint& point, double seconds) {
  return press_and_hold(point.position + point.force / finger.stiffness, 0.1, 1, seconds);
}

HoldVerdict judge_hold(const LoopTrace& trace) {
  const double end = static_cast<double>(trace.command.size()) * trace.period;
  return {rms_above_50_Hz(trace.command, trace.period, end - 2, end - 1),
          rms_above_50_Hz(trace.command, trace.period, end - 1, end),
          rms_above_50_Hz(trace.finger, trace.period, end - 1, end),
          rms_above_50_Hz(trace.finger, trace.period, end - 2, end - 1), trace.guarded};
}

HoldVerdict hold(const ActionFile& action, const ClosedLoopSettings& settings, Hold hold, double seconds) {
  const HoldPoint point = hold_point(action, settings.coupling(), hold);
  return judge_hold(play_loop(action, settings, hold_with(settings.rig.finger, point, seconds)));
}

}  // namespace erard::study
