// What the finger moves and feels. The one place where "down" becomes "clockwise".
#pragma once

#include <algorithm>

#include "erard/mechanics/state.hpp"
#include "erard/solver/drive.hpp"

namespace erard {

/// Displacement of the key at the finger, down positive: y = -L (theta_K - theta_K(0)) [m]
inline double key_position(const Model& model, const State& state) noexcept {
  const Finger& finger = model.finger;
  return -finger.arm * (state.x[finger.body] - model.bodies[finger.body].initial);
}

/// Rate of the same [m/s]
inline double key_velocity(const Model& model, const State& state) noexcept {
  return -model.finger.arm * state.v[model.finger.body];
}

/// Force of the Kelvin-Voigt element at one instant, positive when the finger presses; it cannot pull.
///   F = max(0, a (Y - y) + b (Y' - y'))                                         thesis 5.4.1, Table 3.1
inline double piston_force(const Model& model, const State& state, const DriveSample& piston) noexcept {
  const Finger& finger = model.finger;
  const double force = finger.stiffness * (piston.value - key_position(model, state)) +
                       finger.damping * (piston.rate - key_velocity(model, state));
  return std::max(0.0, force);
}

}  // namespace erard
