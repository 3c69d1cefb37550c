// The coupling of a device as a linear loop: lever, sensor, estimator, Kelvin-Voigt element, delay, held force.
//
//   lever     m y'' = -(d + d_f) y' - k y - f        pressed by a finger k, d_f that means to stay where it is
//   actuator  tau f' + f = u_k-n                     command of n periods ago, held for a period T; tau = 0: at once
//   piston    Y = Hyy(z) y + Hyu(z) u,  V likewise   of the estimator: Hyy = 1 and Hyu = 0 but for the observer
//   command   u_k = a Y_k + b V_k                    the virtual key does not give way: it lies on its bottom
//
// Lever and actuator under a held command are y = -P(z) u, exactly. With Ky = a Hyy + b Hvy and Ku = a Hyu + b Hvu the
// loop is
//   1 + A(z) - Ku(z) = 0       A = Ky z^-n P
// Its parts are stable, so it is stable if and only if the left side does not go round 0 while z goes round the unit
// circle (Nyquist). The gain margin is the factor by which the force may be larger or smaller than what was commanded:
// from 1 to which 1 + g A - Ku never is 0. Without an observer it is as well the factor by which a and b may grow together.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "erard/device/virtual_lever.hpp"
#include "erard/haptics/passivity.hpp"
#include "study/piston_estimator.hpp"

namespace erard::study {

/// What is held by whom, and how late the force comes.
struct LoopCase {
  double lever_mass = 0.06;        // m [kg]
  double lever_viscous = 0.1;      // d [N s/m]
  FingerSettings finger;           // k, d_f
  int delay_periods = 1;           // n >= 0: the command from a sample begins to act n periods after it
  double actuator_lag = 3e-4;      // tau [s]
  double virtual_mass = HUGE_VAL;  // what the virtual key is instead of rigid: a free mass [kg]
};

class CouplingLoop {
 public:
  /// @param period     T of the samples and commands [s]
  /// @param estimator  a linear one, of that period; its answers to impulses are followed until they are over
  /// Throws std::invalid_argument when they are not over after 1000 periods.
  CouplingLoop(const LoopCase& loop, double period, const PistonEstimator& estimator);

  bool is_stable(const Coupling& coupling) const { return gain_margin(coupling, 1) > 0; }

  /// Of a stable loop the margin described above, upwards or downwards, whichever is smaller, at most `most`; else 0.
  double gain_margin(const Coupling& coupling, double most = 100) const;

  /// The bounds of b between which the loop is stable with this a, looked for from below; {0, 0}: nowhere. [N s/m]
  struct Band {
    double least = 0, largest = 0;
  };
  Band stable_damping(double stiffness) const;

  /// rms of the command for white noise of 1 m rms on the position; infinite when it is not stable [N/m]
  double noise_gain(const Coupling& coupling) const;

 private:
  using Complex = std::complex<double>;
  struct Answer {
    Complex value = 0, rate = 0;  // of the piston
  };
  struct Point {
    double angle = 0;              // of z [rad], 0 < angle <= pi
    Complex plant;                 // z^-n P [m/N]
    Answer of_sample, of_command;  // Hyy [-], Hvy [1/s]; Hyu [m/N], Hvu [m/N/s]
    Complex s;                     // j angle / T [1/s]
  };
  static Answer answer_at(const std::vector<DriveSample>& impulse, Complex z);
  Complex command(const Point& point, const Answer& piston, const Coupling& coupling) const;  // Ky or Ku

  double virtual_mass_;
  std::vector<Point> points_;
};

}  // namespace erard::study
