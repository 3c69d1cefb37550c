// One rigid body and the joint on which it hangs.
#pragma once

#include "erard/model/heading.hpp"
#include "erard/model/name.hpp"

namespace erard {

inline constexpr int kGround = -1;  // parent or contact partner that never moves

enum class JointKind {
  hinge,      // coordinate: angle relative to the parent [rad], counterclockwise
  prismatic,  // coordinate: displacement along `direction` of the parent's frame [m]
};

/// Linear spring on one coordinate: load -stiffness (coordinate - rest)      thesis (4.8)
struct CouplingSpring {
  double stiffness = 0;  // kappa: [N m/rad] on a hinge, [N/m] on a slide
  double rest = 0;       // theta_0: RELATIVE coordinate at which the spring is unloaded [rad] or [m]
};

/// A rigid body with its joint. One coordinate each; hinge friction, spring and viscous loss act on that coordinate,
/// hence on the RELATIVE motion of body and parent.
/// Departs from the thesis: (4.12) lets the friction of jack and lever act on absolute rates, although their hinges
/// sit on the whippen; the difference is 0.6 to 0.8 % of the finger force.
struct Body {
  Name name;
  int parent = kGround;  // index below this body's own, or kGround
  JointKind joint = JointKind::hinge;
  Vector2 origin = Vector2::Zero();  // B_O: joint, in the frame of the parent [m]
  Heading direction;                 // of a slide, in the frame of the parent [rad]

  double mass = 0;                   // m_B [kg]
  Vector2 centre = Vector2::Zero();  // B_G: centre of gravity in the body's frame [m]
  double inertia = 0;                // I_B about the body's own origin B_O, not about B_G [kg m^2]

  double viscous = 0;  // c_v >= 0: [N m s/rad] or [N s/m]                     thesis 4.3.4
  double dry = 0;      // c_d >= 0: half-width of the set-valued band [N m] or [N]     thesis (4.6)
  CouplingSpring spring;

  double initial = 0;    // coordinate at the start, relative to the parent [rad] or [m]
  bool is_held = false;  // the joint is clamped at `initial` (a damper taken out of play)
};

}  // namespace erard
