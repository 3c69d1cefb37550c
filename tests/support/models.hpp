// Small mechanisms with known answers.
#pragma once

#include <cmath>

#include "erard/erard.hpp"

namespace erard::test {

/// Point mass on a massless rod, hung at the origin; angle 0 hangs down.
inline Body pendulum_body(double mass, double length) {
  Body body;
  body.mass = mass;
  body.centre = {0, -length};
  body.inertia = mass * length * length;
  return body;
}

inline Model pendulum(double mass, double length, double initial) {
  Model model;
  model.body_count = 1;
  model.bodies[0] = pendulum_body(mass, length);
  model.bodies[0].initial = initial;
  return model;
}

/// Thesis Appendix B, Figure B.2: masses at the ends of two rods. Coordinates: theta_1, theta_2 - theta_1.
inline Model double_pendulum(double m1, double l1, double m2, double l2) {
  Model model;
  model.body_count = 2;
  model.bodies[0] = pendulum_body(m1, l1);
  model.bodies[1] = pendulum_body(m2, l2);
  model.bodies[1].parent = 0;
  model.bodies[1].origin = {0, -l1};
  return model;
}

/// A block that can slide in x and y (two prismatic joints) without turning, resting with a round foot on a plane that
/// falls towards +x at `slope`. No felt.
inline Model block_on_slope(double mass, double slope, double friction) {
  Model model;
  model.body_count = 2;
  model.bodies[0].name = "X";
  model.bodies[0].joint = JointKind::prismatic;
  model.bodies[1].name = "Y";
  model.bodies[1].joint = JointKind::prismatic;
  model.bodies[1].parent = 0;
  model.bodies[1].direction = std::acos(0.0);
  model.bodies[1].mass = mass;
  model.bodies[0].mass = 1e-9 * mass;  // the slide itself
  Contact& contact = model.contacts[0];
  contact.name = "BG";
  contact.body_a = 1;
  contact.body_b = kGround;
  contact.shape_a.radius = 0.01;
  contact.shape_b.kind = ShapeKind::segment;
  contact.shape_b.direction = -slope;
  contact.shape_b.half_length = 100;
  contact.friction = friction;
  model.contact_count = 1;
  model.bodies[1].initial = 0.01 / std::cos(slope);
  return model;
}

/// A ball of radius 1 cm falling on the ground along y.
inline Model falling_ball(double mass, double height, double restitution) {
  Model model = block_on_slope(mass, 0, 0);
  model.bodies[1].initial = 0.01 + height;
  model.contacts[0].restitution = restitution;
  return model;
}

/// The felt law of most contacts of the grand action, thesis (4.10), on a light body.
inline Felt common_felt() {
  Felt felt;
  felt.stiffness = 1.6e10;
  felt.exponent = 2.7;
  felt.damping = 5e7;
  felt.mass = 1.5e-5;
  return felt;
}

inline Model ball_on_felt(double mass, double height) {
  Model model = falling_ball(mass, height, 0);
  model.contacts[0].has_felt = true;
  model.contacts[0].felt = common_felt();
  model.contacts[0].felt.is_carried_by_a = false;
  return model;
}

/// Speed of a mass after it hit the felt of common_felt(), independent of the engine: RK4 on
///   m x'' = -m g + k d^r + b d^2 d',  d = -x, in contact while the force is positive
inline double rebound_speed(double mass, double speed) {
  const double k = 1.6e10, r = 2.7, b = 5e7, h = 1e-7;
  double x = 0, v = -speed;
  const auto acceleration = [&](double position, double rate) {
    const double d = -position;
    return d > 0 ? std::max(0.0, k * std::pow(d, r) - b * d * d * rate) / mass - 9.81 : -9.81;
  };
  do {
    const double a1 = acceleration(x, v), v2 = v + 0.5 * h * a1, a2 = acceleration(x + 0.5 * h * v, v2);
    const double v3 = v + 0.5 * h * a2, a3 = acceleration(x + 0.5 * h * v2, v3), v4 = v + h * a3;
    const double a4 = acceleration(x + h * v3, v4);
    x += h * (v + 2 * v2 + 2 * v3 + v4) / 6;
    v += h * (a1 + 2 * a2 + 2 * a3 + a4) / 6;
  } while (v < 0 || acceleration(x, v) > -9.81);
  return v;
}

/// Runs a mechanism without drive.
template <typename Observer>
void run_free(const Mechanism& mechanism, const Scheme& scheme, double duration, State& state, Observer&& observer) {
  Workspace work;
  const long steps = std::lround(duration / scheme.time_step);
  for (long k = 0; k < steps; ++k) observer(step(mechanism, scheme, {}, state, work), state);
}

inline void run_free(const Mechanism& mechanism, const Scheme& scheme, double duration, State& state) {
  run_free(mechanism, scheme, duration, state, [](const StepReport&, const State&) {});
}

/// Four internal steps a period of 2 kHz, 0.125 ms.
inline Scheme default_scheme() {
  TickSettings settings;
  settings.set_rate(2000, 4);
  return settings.scheme;
}

}  // namespace erard::test
