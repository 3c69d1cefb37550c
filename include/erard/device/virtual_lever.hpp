// The lever of the virtual device: one mass between the finger and the actuator, with dry friction and end stops that are
// exactly set-valued.
#pragma once

#include <algorithm>
#include <cmath>

namespace erard {

struct LeverSettings {
  double mass = 0.1;            // effective, at the finger [kg]; 0.06 to 0.2 of real key levers
  double dry_friction = 0.05;   // c, of the bearing, at the finger [N]
  double viscous = 0.1;         // d [N s/m]
  double return_force = 0;      // of a spring that lifts the lever, at the upper stop [N]
  double return_stiffness = 0;  // of the same [N/m]
  double depth = 0.015;         // of the lower stop under the upper one, which is at 0; a key bottom and 20 N [m]
};

/// The finger's skin and joints, seen by the lever: it pushes and cannot pull.
///   F = max(0, k (X - y) + d (X' - y'))        X: where the finger would be if nothing were in its way
struct FingerSettings {
  double stiffness = 1000;  // k [N/m]
  double damping = 5;       // d [N s/m]
};

/// A lever held by something fixed instead of a finger: the hardest that a hand, a book or a clamp could be.
inline constexpr FingerSettings kRigidStop{5e4, 1};

/// Position and rate of the intended motion, or of the lever.
struct Motion {
  double position = 0;  // [m], down positive
  double velocity = 0;  // [m/s]
};

inline double finger_force(const FingerSettings& finger, const Motion& intended, const Motion& lever) noexcept {
  return std::max(0.0, finger.stiffness * (intended.position - lever.position) +
                           finger.damping * (intended.velocity - lever.velocity));
}

/// What the actuator does to the lever during one sub-step.
struct ActuatorLoad {
  double push = 0;  // force, up positive [N]
  double grip = 0;  // largest force by which it resists sliding [N]
};

/// One sub-step of h seconds,
///   m (v1 - v0) / h  in  F - push - return - d v - (c + grip) Sgn(v1)
/// with F, the return spring and d v at the middle of the step (second order) and Sgn at its end, where it is the set
/// [-1, 1] at v1 = 0: a lever that sticks has v1 = 0 and keeps every bit of its position. Increasing in v1 with one kink,
/// where the finger lifts off, so it is solved in closed form. A stop is inelastic: who would pass it stays on it.
/// @param intended  at the middle of the step
inline Motion advance_lever(const LeverSettings& lever, const FingerSettings& finger, const Motion& intended,
                            const ActuatorLoad& load, double h, const Motion& from) noexcept {
  const double y0 = from.position, v0 = from.velocity, m = lever.mass;
  // the finger pushes with max(0, A - B v1), the rest with P - C v1
  const double A =
      finger.stiffness * (intended.position - y0 - h * v0 / 4) + finger.damping * (intended.velocity - v0 / 2);
  const double B = finger.stiffness * h / 4 + finger.damping / 2;
  const double P =
      -load.push - lever.return_force - lever.return_stiffness * (y0 + h * v0 / 4) - lever.viscous * v0 / 2;
  const double C = lever.return_stiffness * h / 4 + lever.viscous / 2;

  const double dry = h * (lever.dry_friction + load.grip);
  const double impulse = m * v0 + h * P;                  // without finger and friction [N s]
  const double pressed = impulse + h * std::max(0.0, A);  // with the finger, were the lever to stop
  double v1 = 0;
  if (std::abs(pressed) > dry) {
    const double left = impulse - std::copysign(dry, pressed);
    v1 = (left + h * A) / (m + h * (B + C));
    if (A - B * v1 < 0) v1 = left / (m + h * C);
  }
  const double y1 = y0 + h * (v0 + v1) / 2;
  if (y1 < 0) return {0, 0};
  if (y1 > lever.depth) return {lever.depth, 0};
  return {y1, v1};
}

}  // namespace erard
