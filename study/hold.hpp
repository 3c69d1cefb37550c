// Does a device keep still when a finger does?
#pragma once

#include <vector>

#include "study/closed_loop.hpp"

namespace erard::study {

/// Where a finger holds the lever for a long time.
enum class Hold {
  at_rest,      // touching the key, with less than its weight
  at_let_off,   // where the jack has met the let-off button and the hammer is about to escape
  on_bottom,    // pressing the key into the front rail punching with 5 N
  firm_bottom,  // the same with 15 N: the felt is stiff then; the 20 N of a guard are not reached
};
inline constexpr Hold kHolds[] = {Hold::at_rest, Hold::at_let_off, Hold::on_bottom, Hold::firm_bottom};
const char* name_of(Hold hold);

/// Where the lever and the finger's force are then: found by pressing the action slowly through the coupling.
struct HoldPoint {
  double position = 0;  // of the lever [m]
  double force = 0;     // [N]
};
/// Throws std::runtime_error when the action has no such place.
HoldPoint hold_point(const ActionFile& action, const Coupling& coupling, Hold hold);

/// A finger that comes there within a second and stays for `seconds`: X = position + force / k.
Keystroke hold_with(const FingerSettings& finger, const HoldPoint& point, double seconds);

/// rms of what is above 50 Hz in part of a signal [its unit]: a high pass of the fourth order (Butterworth), run from
/// the beginning of the signal.
double rms_above_50_Hz(const std::vector<double>& signal, double period, double from, double until);

/// What became of a hold. A stable loop does not grow: in the last second the command's rms above 50 Hz is at most
/// kNoGrowth times that of the second before; nor does it stand above what noise makes of it. Growth alone would let a
/// limit cycle pass, which the actuator's limit holds.
struct HoldVerdict {
  double before = 0, last = 0;  // rms of the command above 50 Hz in the last but one and the last second [N]
  double finger = 0;            // the same of the finger's force in the last second [N]
  double finger_before = 0;     // and in that before
  double guarded = 0;           // part of the time in which the passivity controller acted
  bool grows() const { return last > kNoGrowth * before + kSilence; }

  /// Two seconds of stationary noise of 2000 samples each differ by 5 % where it is correlated over ten of them.
  static constexpr double kNoGrowth = 1.2;
  static constexpr double kSilence = 1e-6;  // [N] below it ratios say nothing
};
HoldVerdict judge_hold(const LoopTrace& trace);
HoldVerdict hold(const ActionFile& action, const ClosedLoopSettings& settings, Hold hold, double seconds);

}  // namespace erard::study
