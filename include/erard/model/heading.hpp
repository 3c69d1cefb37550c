// A direction in the plane.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace erard {

using Vector2 = Eigen::Vector2d;

/// An angle that keeps its unit vector at hand, so that nobody takes its sine again in every step.
class Heading {
 public:
  Heading(double angle = 0) noexcept : angle_(angle), unit_(std::cos(angle), std::sin(angle)) {}

  operator double() const noexcept { return angle_; }            // [rad]
  const Vector2& unit_vector() const noexcept { return unit_; }  // (cos, sin)

 private:
  double angle_;
  Vector2 unit_;
};

}  // namespace erard
