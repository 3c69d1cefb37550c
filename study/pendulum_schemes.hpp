// One step of a pendulum with dry friction, in the schemes that thesis 5.1 and 5.2 compare, and in the engine.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "erard/erard.hpp"
#include "study/pendulum_exact.hpp"

namespace erard::study {

/// theta'' + Y^2 sign theta' + 4 pi^2 sin theta = 0 in steps of 1/Theta             thesis (5.6), Table 5.1
struct PendulumCase {
  double upsilon = 5;  // Y: friction against gravity [-]
  double psi = 1e4;    // Psi: slope of the regularised sign [T/rad]; the others do not look at it
  int steps = 20;      // Theta: steps a period
  PendulumState start = {1, 0};
};

/// sign, made a ramp of slope Psi                                                              thesis (5.11)
inline double regularised_sign(double psi, double rate) { return std::clamp(psi * rate, -1.0, 1.0); }

/// Explicit Euler with the regularised law                                              thesis (5.17)-(5.18)
///   theta_e = theta + h theta'     theta'_e = theta' - h (4 pi^2 sin theta + Y^2 sign~ theta')
struct ExplicitEuler {
  PendulumState operator()(const PendulumCase& c, const PendulumState& s) const {
    const double h = 1.0 / c.steps;
    const double friction = c.upsilon * c.upsilon * regularised_sign(c.psi, s.rate);
    return {s.angle + h * s.rate, s.rate - h * (kPendulumGravity * std::sin(s.angle) + friction)};
  }
};

enum class FrictionLaw {
  linearised,   // regularised: one Newton step from the rate at the start                thesis (5.25)
  regularised,  // regularised, and met by the rate at the end: the (non-linear) implicit Euler scheme
  set_valued,   // sign itself, met by the rate at the end                                  thesis (5.43)-(5.45)
};

enum class Gravity {
  at_start,    // 4 pi^2 sin theta                                                          thesis (5.42)
  linearised,  // 4 pi^2 (sin theta + cos theta (theta_e - theta)): one Newton step towards implicit Euler
};

/// Euler schemes whose position follows the rate at the end, theta_e = theta + h theta'_e. All of them solve
///   a theta'_e + h Y^2 sigma = p,   p = theta' - 4 pi^2 h sin theta
///   a = 1 (gravity at the start) or 1 + 4 pi^2 h^2 cos theta (linearised);   sigma by the friction law
struct EulerScheme {
  FrictionLaw friction;
  Gravity gravity;

  PendulumState operator()(const PendulumCase& c, const PendulumState& s) const {
    const double h = 1.0 / c.steps;
    const double a = gravity == Gravity::at_start ? 1.0 : 1 + kPendulumGravity * h * h * std::cos(s.angle);
    const double p = s.rate - h * kPendulumGravity * std::sin(s.angle);
    const double rate = end_rate(c, s.rate, a, p, h * c.upsilon * c.upsilon);
    return {s.angle + h * rate, rate};
  }

 private:
  /// @param band  h Y^2: what friction can take from the rate in a step
  double end_rate(const PendulumCase& c, double rate, double a, double p, double band) const {
    if (friction == FrictionLaw::set_valued) return (p - std::clamp(p, -band, band)) / a;
    const double ramp = band * c.psi;
    if (friction == FrictionLaw::regularised) {
      const double held = p / (a + ramp);  // on the ramp
      return std::abs(held) <= 1 / c.psi ? held : (p - std::copysign(band, p)) / a;
    }
    return std::abs(rate) <= 1 / c.psi ? p / (a + ramp) : (p - std::copysign(band, rate)) / a;
  }
};

/// The linearly implicit regularised scheme                                              thesis (5.22)-(5.26)
inline constexpr EulerScheme kLinearlyImplicit{FrictionLaw::linearised, Gravity::linearised};
/// The projected, non-smooth scheme                                                             thesis (5.46)
inline constexpr EulerScheme kProjected{FrictionLaw::set_valued, Gravity::at_start};

/// The engine's own step() on a hinge with dry friction; theta 1 is implicit Euler, 1/2 the middle scheme.
struct EngineScheme {
  double theta;
};

using PendulumScheme = std::variant<ExplicitEuler, EulerScheme, EngineScheme>;

/// Unit mass on a rod of unit length; gravity and friction such that the engine's second is the period T.
inline Model pendulum_model(const PendulumCase& c) {
  Model model;
  model.gravity = {0, -kPendulumGravity};
  model.body_count = 1;
  Body& body = model.bodies[0];
  body.mass = 1;
  body.centre = {0, -1};
  body.inertia = 1;
  body.dry = c.upsilon * c.upsilon;
  body.initial = c.start.angle;
  return model;
}

/// Gives the states k = 0 .. count to `observe(k, state)`.
/// @return false when a step of the engine did not converge (implicit Euler below ten steps a period)
template <typename Observe>
bool run_pendulum(const PendulumScheme& pendulum_scheme, const PendulumCase& c, long count, Observe&& observe) {
  bool is_converged = true;
  const auto run_small = [&](const auto& one_step) {
    PendulumState state = c.start;
    observe(0L, state);
    for (long k = 1; k <= count; ++k) {
      state = one_step(c, state);
      observe(k, state);
    }
  };
  const auto run_engine = [&](const EngineScheme& engine) {
    const Mechanism mechanism = build_mechanism(pendulum_model(c));
    Scheme scheme;
    scheme.time_step = 1.0 / c.steps;
    scheme.theta = engine.theta;
    State state = rest_state(mechanism, scheme.time_step);
    state.v[0] = c.start.rate;
    Workspace work;
    observe(0L, PendulumState{state.x[0], state.v[0]});
    for (long k = 1; k <= count; ++k) {
      is_converged = step(mechanism, scheme, {}, state, work).status == StepStatus::converged && is_converged;
      observe(k, PendulumState{state.x[0], state.v[0]});
    }
  };
  if (const auto* engine = std::get_if<EngineScheme>(&pendulum_scheme))
    run_engine(*engine);
  else if (const auto* euler = std::get_if<EulerScheme>(&pendulum_scheme))
    run_small(*euler);
  else
    run_small(ExplicitEuler{});
  return is_converged;
}

}  // namespace erard::study
