// What a finger feels of the action through a device, against the action itself.
#pragma once

#include <string>
#include <vector>

#include "study/closed_loop.hpp"

namespace erard::study {

/// A stroke on the action itself, with the thesis's finger, and what another finger has to intend to play the same one.
struct ReferenceStroke {
  std::string name;
  double end = 0;           // up to which forces are compared: the release [s]
  ForceCurve force;         // of the finger [N]
  std::vector<double> key;  // its positions, at the same times [m]
  double hammer_speed = 0;  // [m/s]
};
ReferenceStroke reference_stroke(const ActionFile& action, const std::string& keystroke, double end);

/// X(t) with k (X - y) + d (X' - y') = F, the key position and force of the stroke: on an ideal device this finger
/// would feel just that force. Solved exactly between samples, y and F on straight lines.
Keystroke intended_by(const FingerSettings& finger, const ReferenceStroke& stroke);

struct Fidelity {
  double eta = 0;           // of the finger's force, thesis (6.3)
  double rms = 0;           // of its error [N]
  double hammer_speed = 0;  // relative difference
  double guarded = 0;       // part of the periods in which the passivity controller acted
};
Fidelity fidelity(const ActionFile& action, const ClosedLoopSettings& settings, const ReferenceStroke& stroke);

/// The mass that the lever has is taken from the simulated key: what is real need not be rendered.
/// At most all but a tenth of the key's own.
ActionFile without_lever_mass(const ActionFile& action, double lever_mass);

}  // namespace erard::study
