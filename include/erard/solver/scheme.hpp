// Settings of the time stepping.
#pragma once

#include <limits>

namespace erard {

/// theta scheme with contacts at the end of the step (gamma = 1)                  thesis (5.37)-(5.39)
struct Scheme {
  double time_step = 1.25e-4;  // h of one internal step [s]
  double theta = 0.5;          // weight of the end of the step, 0.5 (second order) to 1 (Euler) [-]
  double surprise_limit = std::numeric_limits<double>::infinity();  // refuse steps that surprise by more [m/s^2]
  int newton_limit = 12;                                            // linearisations a step, at most
  double newton_tolerance = 1e-2;    // change of the end velocity, relative [-]; the next one would be about its square
  double placement_tolerance = 0.1;  // the same, since the frames were placed, above which they are placed again [-]
  bool is_friction_recalled = true;  // try the friction of the step before; false: sweep every one-step problem
  int sweep_limit = 200;             // Gauss-Seidel sweeps a linearisation, at most
  double sweep_tolerance = 1e-6;     // change of a row in one sweep, relative to the free velocities of its unit [-]
};

}  // namespace erard
