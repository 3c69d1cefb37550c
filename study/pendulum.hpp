// Study: the pendulum with dry friction of thesis 5.1 and 5.2, regularised, projected, and in the engine.
#pragma once

#include <vector>

#include "study/pendulum_schemes.hpp"
#include "study/section.hpp"

namespace erard::study {

inline constexpr int kPendulumPeriods = 5;  // length of the thesis's plots

/// Steps a period of the error table.
inline const std::vector<int> kPendulumSteps{10, 15, 20, 40, 80, 160, 250, 500, 1000};

// Results are not a number when a step of the engine did not converge.

/// Mean of |angle - exact| over the steps k = 0 .. 5 Theta [rad], the measure of thesis 5.2.5.
double mean_error(const PendulumScheme& scheme, const PendulumCase& c, const ExactPendulum& exact);

/// Steps a period that keep the mean error within a tolerance. 0: not found up to the limit.
struct StepsNeeded {
  int first = 0;    // the fewest that reach it
  int lasting = 0;  // the fewest from which on all reach it, up to the limit
};

/// Looks at every number of steps from 5 to 100, then in rungs of 1 %.
/// @param tolerance  of the mean error [rad]
/// @param limit      largest number of steps a period looked at
StepsNeeded steps_needed(const PendulumScheme& scheme, PendulumCase c, double tolerance, int limit);

/// What a pendulum does when it should hang still: the minute after the first five periods.
struct PendulumRest {
  double angle = 0;    // at the beginning of that minute [rad]
  double fastest = 0;  // largest |rate| in it [rad/T]
  double drift = 0;    // angle at its end, less that at its beginning [rad]
};
PendulumRest rest_of(const PendulumScheme& scheme, const PendulumCase& c);

/// Angle after five periods [rad].
double final_angle(const PendulumScheme& scheme, const PendulumCase& c);

/// Spectral radius of the matrix C of the explicit scheme, linearised about 0             thesis (5.19)-(5.21)
double explicit_spectral_radius(const PendulumCase& c);

/// Amplitude above which explicit Euler gains more in a sliding half swing than dry friction takes from it [rad]
///   a (exp(pi^2 / Theta) - 1) = 2 Y^2 / (4 pi^2)   small angles; half a period grows by (1 + 4 pi^2/Theta^2)^(Theta/4)
double explicit_growth_threshold(const PendulumCase& c);

/// Computing time of one step [s]: the shortest of several runs of five periods, less what goes before the first step.
double seconds_per_step(const PendulumScheme& scheme, const PendulumCase& c);

/// The section of docs/validation.md, with its pictures.
Section pendulum_section(const Pictures& pictures);

}  // namespace erard::study
