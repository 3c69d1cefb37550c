// The exact motion of a pendulum with dry friction: half swings between turning points.
#pragma once

#include <vector>

namespace erard::study {

/// (2 pi)^2: gravity over length when time is counted in periods of the small frictionless swing [1/T^2]
inline constexpr double kPendulumGravity = 4 * 3.141592653589793 * 3.141592653589793;

/// Time is in periods T of the small frictionless swing, thesis (5.4); with T = 1 s it is in seconds.
struct PendulumState {
  double angle = 0;  // theta, 0 hangs down [rad]
  double rate = 0;   // theta' [rad/T]
};

/// One stretch of motion in one direction. Friction is constant on it, so that energy gives the rate at every angle.
struct HalfSwing {
  double start = 0;                     // time [T]
  double duration = 0;                  // [T]
  PendulumState from;                   // at the start: at rest, but for a first swing that is thrown
  double to = 0;                        // angle at which it turns [rad]
  std::vector<double> angle{}, rate{};  // at equal parts of the duration, both ends included
};

/// theta'' + Y^2 sign theta' + 4 pi^2 sin theta = 0                               thesis (5.6)
class ExactPendulum {
 public:
  /// @param upsilon  Y = 2 pi sqrt(c_d / (m g l)), thesis (5.7) [-]
  /// @param start    |angle| < pi, and too slow to go over the top: throws std::invalid_argument otherwise.
  ///                 At rest or clearly thrown: the quadrature of a start that hardly moves is poor.
  ExactPendulum(double upsilon, PendulumState start);

  const std::vector<HalfSwing>& swings() const { return swings_; }
  double stick_time() const { return stick_time_; }    // [T]
  double stick_angle() const { return stick_angle_; }  // [rad]

  /// Angle at a time >= 0 [rad]; to 1e-11.
  double angle_at(double time) const;

 private:
  std::vector<HalfSwing> swings_;
  double stick_time_ = 0;
  double stick_angle_ = 0;
};

}  // namespace erard::study
