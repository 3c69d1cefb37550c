// The closed loop of a device and its action, offline: the virtual rig, an estimator, the engine, a delay. Deterministic,
// and a few hundred times faster than the clock.
#pragma once

#include <string>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/force_curve.hpp"
#include "erard/device/rig.hpp"
#include "erard/haptics/tick.hpp"
#include "study/coupling_loop.hpp"

namespace erard::study {

struct ClosedLoopSettings {
  RigSettings rig;
  PistonEstimator estimator = SlidingPolynomial(5e-4, 2, 1);
  Coupling coupling;
  int delay_periods = 1;        // from a sample to the instant from which its force acts
  double period = 5e-4;         // [s]
  double release_speed = 0.01;  // a brake is let go when the lever rises faster than this [m/s]
};

/// At the ends of the periods, but for the command: it was computed from the sample at the start.
struct LoopTrace {
  double period = 0;               // [s]
  std::vector<double> command;     // what the device is asked to lift the lever with [N]
  std::vector<double> finger;      // force of the finger on the lever [N]
  std::vector<double> lever, key;  // positions, of the device and of the simulated key [m]
  double hammer_speed = 0;         // at the first string impact; 0 without [m/s]

  /// Finger force as a curve from `start` on.
  ForceCurve finger_curve(double start) const;
};

/// Plays an intended motion of the finger, from its start to its end, on the device.
LoopTrace play_loop(const ActionFile& action, const ClosedLoopSettings& settings, const Keystroke& intended);

/// rms of what is above 50 Hz in part of a signal [its unit]: a high pass of the fourth order (Butterworth), run from the
/// beginning of the signal.
double rms_above_50_Hz(const std::vector<double>& signal, double period, double from, double until);

/// Where a finger holds the lever for a long time.
enum class Hold {
  at_rest,     // touching the key, with less than its weight
  at_let_off,  // where the jack has met the let-off button and the hammer is about to escape
  on_bottom,   // pressing the key into the front rail punching
};
inline constexpr Hold kHolds[] = {Hold::at_rest, Hold::at_let_off, Hold::on_bottom};
const char* name_of(Hold hold);

/// Where the lever and the finger's force are then: found by pressing the action slowly through the coupling.
struct HoldPoint {
  double position = 0;  // of the lever [m]
  double force = 0;     // [N]
};
HoldPoint hold_point(const ActionFile& action, const Coupling& coupling, Hold hold);

/// A finger that comes there within a second and stays for `seconds`: X = position + force / k.
Keystroke hold_with(const FingerSettings& finger, const HoldPoint& point, double seconds);

/// What became of a hold. Stable is what neither grows nor buzzes:
///   the command's rms above 50 Hz in the last second is at most kNoGrowth times that of the second before, and at most
///   kBuzz. Growth alone would let a limit cycle pass that the actuator's limit holds.
struct HoldVerdict {
  double before = 0, last = 0;  // rms of the command above 50 Hz in the last but one and the last second [N]
  double finger = 0;            // the same of the finger's force in the last second [N]
  bool is_stable = false;
};
/// Ratio of the rms of two seconds of stationary noise: 2000 samples with a correlation time of ten scatter by 5 %.
inline constexpr double kNoGrowth = 1.2;
/// @param buzz  most that counts as stable [N]
HoldVerdict judge_hold(const LoopTrace& trace, double buzz);
HoldVerdict hold(const ActionFile& action, const ClosedLoopSettings& settings, Hold hold, double seconds, double buzz);

/// A stroke on the action itself, with the thesis's finger, and what another finger has to intend to play the same one.
struct ReferenceStroke {
  std::string name;
  double end = 0;           // up to which forces are compared: the release [s]
  ForceCurve force;         // of the finger [N]
  std::vector<double> key;  // its positions, at the same times [m]
  double hammer_speed = 0;  // [m/s]
};
ReferenceStroke reference_stroke(const ActionFile& action, const std::string& keystroke, double end);

/// X(t) with k (X - y) + d (X' - y') = F, the key position and force of the stroke: on an ideal device this finger would feel
/// just that force. Solved exactly between samples for a right side on straight lines.
Keystroke intended_by(const FingerSettings& finger, const ReferenceStroke& stroke);

struct Fidelity {
  double eta = 0;           // of the finger's force, thesis (6.3)
  double rms = 0;           // of its error [N]
  double hammer_speed = 0;  // relative difference
};
Fidelity fidelity(const ActionFile& action, const ClosedLoopSettings& settings, const ReferenceStroke& stroke);

/// The mass that the lever has is taken from the simulated key: what is real need not be rendered.
/// At most all but a tenth of the key's own.
ActionFile without_lever_mass(const ActionFile& action, double lever_mass);

}  // namespace erard::study
