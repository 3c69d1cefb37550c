// Models of the action with one degree of freedom: the blocked hammer and the simplistic key, thesis chapter 2.
//
// Angles, moments and forces are counted positive when the key is pressed: theta = y / L. The thesis counts angles and
// moments counterclockwise, where theta_K and the pianist's moment are negative; its weights C_w then stand with the
// opposite sign: minus C_w on the left of (2.6) is a weight that resists.
#pragma once

#include <array>
#include <vector>

#include "erard/device/keystroke.hpp"

namespace erard::study::simple {

/// What was measured on the separate parts and on the assembled action                     thesis Table 2.1, 2.2
/// Index 0 key, 1 whippen with jack and lever, 2 hammer.
struct KeyParts {
  double arm = 0;                   // L [m]
  double alpha21 = 0, alpha31 = 0;  // lever ratios (2.1) [-]
  std::array<double, 3> inertia{};  // J_i, about the part's own axis [kg m^2]
  std::array<double, 3> weight{};   // C_wi, counterclockwise as printed [N m]
  std::array<double, 3> viscous{};  // c_vi [N m s/rad]
  double key_dry = 0;               // C_d1 [N m]
  double spring = 0;                // kappa_2, between whippen and ground [N m/rad]
  double spring_rest = 0;           // theta_2^0 [rad]
  double down_force = 0;            // F_down [N]
  double up_force = 0;              // F_up [N]
};

/// Table 2.1 and the static test of 2.2; the ratios from its lengths l12, l21, l23, l32.
KeyParts thesis_parts();

/// The parts as one body on the axis of the key.
struct Equivalents {
  double inertia = 0;        // J    (2.2) [kg m^2]
  double weight = 0;         // C_w  (2.4), resisting [N m]
  double static_weight = 0;  // C_w  (2.7) [N m]
  double dry = 0;            // C_d  (2.8) [N m]
  double viscous = 0;        // c_v  (2.4) [N m s/rad]
  double spring = 0;         // kappa (2.4) [N m/rad]
  double spring_rest = 0;    // theta_0 = theta_2^0 / alpha_21 [rad]
};

/// J = J_1 + a21^2 J_2 + a31^2 J_3,  C_w = C_w1 - a21 C_w2 + a31 C_w3,  c_v = c_v1 + a21^2 c_v2 + a31^2 c_v3,
/// kappa = a21^2 kappa_2                                                                    thesis (2.2), (2.4)
/// C_w = L (F_down + F_up) / 2,  C_d = L (F_down - F_up) / 2                                thesis (2.7), (2.8)
Equivalents equivalents(const KeyParts& parts);

/// One body on the axis of the key, without its stops:
///   J theta'' + c_v theta' + C_d Sign(theta') + load + kappa theta = L F                   thesis (2.5), (2.6)
struct OneBody {
  double inertia = 0;    // J [kg m^2]
  double viscous = 0;    // c_v [N m s/rad]
  double dry = 0;        // C_d [N m]
  double load = 0;       // resisting moment at theta = 0 [N m]
  double stiffness = 0;  // kappa of (2.6), K of (2.5) [N m/rad]
};

/// Front rail punching: F = k d^r + b d^2 d', d = arm (theta - angle), never below 0        thesis (2.3)
struct Punching {
  double arm = 0;        // [m]
  double angle = 0;      // theta_p [rad]
  double stiffness = 0;  // k [N/m^r]
  double exponent = 1;   // r [-]
  double damping = 0;    // b [N s/m^3]
};

/// How the simplistic key takes over from the blocked hammer.
enum class Takeover {
  keeps_momentum,  // J_1 theta'_1 = J theta': what forces inside the action must do
  keeps_velocity,  // theta' stays: what (2.6) does with an inertia that is interpolated over the takeover
};

/// The two models in succession, over a rigid rest (theta >= 0).
struct SimpleAction {
  double arm = 0;             // L [m]
  OneBody blocked;            // BH, below `takeover_angle`
  OneBody key;                // SK, from the first time that angle is reached
  double takeover_angle = 0;  // [rad]; 0: the simplistic key alone
  Takeover takeover = Takeover::keeps_momentum;
  Punching rail;
};

/// BH and SK of some parts, without punching. The weight is that of the static test (2.7), which holds the whippen
/// spring already; K cannot be had from parts.
/// @param stiffness  K [N m/rad]
SimpleAction simple_action(const KeyParts& parts, double stiffness);

/// BH and SK with the numbers of Table 2.2, C_w of the static test.
SimpleAction thesis_action();

/// The same with C_w and the spring as (2.6) prints them: kappa (theta - theta_0), in the thesis's counterclockwise
/// angles, on the side of the weights.
SimpleAction thesis_action_with_printed_spring();

/// Where the blocked hammer's static moment has grown to that of the simplistic key, L F_down: the condition of (2.5)
/// and (2.6) as an angle, so that it is the same whichever quantity drives.
///   theta = (load + C_d - load_1 - C_d1) / (K - kappa) [rad]
double takeover_angle(const OneBody& blocked, const OneBody& key);

/// A motion of the key at rising instants; all of one length.
struct KeyMotion {
  std::vector<double> time;          // [s]
  std::vector<double> angle;         // [rad]
  std::vector<double> rate;          // [rad/s]
  std::vector<double> acceleration;  // [rad/s^2]; empty where nobody asked
};

/// State of the key at one instant.
struct KeyStart {
  double time = 0;   // [s]
  double angle = 0;  // [rad]
  double rate = 0;   // [rad/s]
};

/// Motion under a force: angle and rate at `times` that are not before the start.
/// Time stepping at the middle of the step: half a step of drift, the whole step's moments there, half a step of drift
/// (second order, symplectic without losses). Dry friction and the rest are set-valued and solved exactly: over a step
/// friction takes at most C_d h and stops the body when that suffices, so a body at rest stays at rest. Steps of 5e-5 s
/// leave at most 2 um of error in the strokes of this study (against 1e-6 s).
/// @param force  of the finger [N], quantity force
/// @param step   longest step [s]
KeyMotion move(const SimpleAction& action, const Keystroke& force, const std::vector<double>& times,
               const KeyStart& start = {}, double step = 5e-5);

/// Force under a motion: (2.5), then (2.6), at each instant of the motion [N]. It may be negative: the equations do not
/// know that a finger cannot pull. Sign(0) is 0. The blow of a sudden takeover is not part of it.
std::vector<double> feel(const SimpleAction& action, const KeyMotion& motion);

/// Derivative by central differences, one-sided at the ends.
std::vector<double> differentiate(const std::vector<double>& time, const std::vector<double>& value);

/// Integral by the trapezoid rule, `start` at the first instant.
std::vector<double> integrate(const std::vector<double>& time, const std::vector<double>& value, double start);

}  // namespace erard::study::simple
