// The closed loop of a device and its action, offline and deterministic: the virtual rig, a host that answers its
// samples with commands, a delay.
#pragma once

#include <variant>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/force_curve.hpp"
#include "erard/device/rig.hpp"
#include "erard/haptics/renderer.hpp"
#include "study/coupling_loop.hpp"

namespace erard::study {

/// The least that a host can do: estimate, simulate one period, send the force. A brake is let go while the lever rises
/// faster than `release_speed`, since it would hold it back.
struct PlainHost {
  PistonEstimator estimator = SlidingPolynomial(5e-4, 2, 1);
  Coupling coupling;
  double release_speed = 0.01;  // [m/s]
};

/// The host's whole pipeline, with what it watches, guards and damps. Its actuator must be of the rig's kind.
struct PipelineHost {
  RenderSettings rendering;
};

struct ClosedLoopSettings {
  RigSettings rig;
  std::variant<PlainHost, PipelineHost> host = PlainHost{};
  int delay_periods = 1;  // from a sample to the instant from which its force acts
  double period = 5e-4;   // [s]

  Coupling coupling() const;
};

/// At the ends of the periods, but for the command: it was computed from the sample at the start.
struct LoopTrace {
  double period = 0;            // [s]
  std::vector<double> command;  // what the device is asked to lift the lever with, or a brake to resist with [N]
  std::vector<double> finger;   // force of the finger on the lever [N]
  std::vector<double> lever;    // where it is [m]
  double hammer_speed = 0;      // at the first string impact; 0 without [m/s]
  double guarded = 0;           // part of the periods in which the pipeline's passivity controller acted

  /// Finger force as a curve from `start` on.
  ForceCurve finger_curve(double start) const;
};

/// Plays an intended motion of the finger, from its start to its end, on the device.
/// Throws std::runtime_error when the simulation is not finite.
LoopTrace play_loop(const ActionFile& action, const ClosedLoopSettings& settings, const Keystroke& intended);

}  // namespace erard::study
