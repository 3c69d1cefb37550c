#include "study/pendulum_exact.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace erard::study {
namespace {

constexpr double kG = kPendulumGravity;
constexpr int kParts = 2000;  // of a half swing: leaves a rate of 1e-11 rad/T at its end

/// Half the square of the rate at an angle that a motion in one direction has reached: kinetic energy at its start,
/// plus the work of gravity, less that of friction.
double kinetic_energy(double upsilon, const PendulumState& from, double angle) {
  return 0.5 * from.rate * from.rate + kG * (std::cos(angle) - std::cos(from.angle)) -
         upsilon * upsilon * std::abs(angle - from.angle);
}

/// Where it turns: the zero of the kinetic energy. That falls from the balance of gravity and friction up to the top.
double turning_angle(double upsilon, const PendulumState& from, int direction) {
  const double balance = std::asin(std::min(1.0, upsilon * upsilon / kG));
  double inside = std::max(direction * from.angle, -balance);  // angles along the direction of motion
  double outside = M_PI;
  if (kinetic_energy(upsilon, from, direction * outside) >= 0)
    throw std::invalid_argument("this pendulum goes over the top");
  while (true) {
    const double middle = 0.5 * (inside + outside);
    if (middle <= inside || middle >= outside) return direction * inside;
    (kinetic_energy(upsilon, from, direction * middle) > 0 ? inside : outside) = middle;
  }
}

/// Duration of a half swing: integral of d angle / rate. The substitution angle = to - R (1 - sin phi) takes the
/// infinite integrand out of both ends (out of the last alone when the start is thrown); Gauss, three points a panel.
double swing_duration(double upsilon, const PendulumState& from, double to) {
  const bool is_thrown = from.rate != 0;
  const double radius = is_thrown ? to - from.angle : 0.5 * (to - from.angle);
  const double first = is_thrown ? 0.0 : -M_PI_2;
  constexpr int kPanels = 100;
  const double width = (M_PI_2 - first) / kPanels;
  const double offset = 0.5 * width * std::sqrt(0.6);
  const auto integrand = [&](double phi) {
    const double angle = to - radius * (1 - std::sin(phi));
    return std::abs(radius) * std::cos(phi) / std::sqrt(2 * kinetic_energy(upsilon, from, angle));
  };
  double sum = 0;
  for (int i = 0; i < kPanels; ++i) {
    const double middle = first + (i + 0.5) * width;
    sum += (5 * integrand(middle - offset) + 8 * integrand(middle) + 5 * integrand(middle + offset)) / 18;
  }
  return sum * width;
}

/// The way between the ends, by Runge-Kutta of fourth order: friction is constant here, the equation is smooth.
void trace(double upsilon, int direction, HalfSwing& swing) {
  const double h = swing.duration / kParts;
  const auto acceleration = [&](double angle) { return -kG * std::sin(angle) - direction * upsilon * upsilon; };
  double x = swing.from.angle, v = swing.from.rate;
  swing.angle = {x};
  swing.rate = {v};
  for (int i = 0; i < kParts; ++i) {
    const double x2 = x + 0.5 * h * v, v2 = v + 0.5 * h * acceleration(x);
    const double x3 = x + 0.5 * h * v2, v3 = v + 0.5 * h * acceleration(x2);
    const double x4 = x + h * v3, v4 = v + h * acceleration(x3);
    v += h / 6 * (acceleration(x) + 2 * acceleration(x2) + 2 * acceleration(x3) + acceleration(x4));
    x += h / 6 * (swing.rate.back() + 2 * v2 + 2 * v3 + v4);
    swing.angle.push_back(x);
    swing.rate.push_back(v);
  }
}

}  // namespace

ExactPendulum::ExactPendulum(double upsilon, PendulumState start) {
  if (!(upsilon > 0) || !(std::abs(start.angle) < M_PI)) throw std::invalid_argument("upsilon > 0, |angle| < pi");
  double time = 0;
  PendulumState from = start;
  while (from.rate != 0 || kG * std::abs(std::sin(from.angle)) > upsilon * upsilon) {
    const bool is_forward = from.rate != 0 ? from.rate > 0 : from.angle < 0;
    const int direction = is_forward ? 1 : -1;
    HalfSwing swing{.start = time, .from = from, .to = turning_angle(upsilon, from, direction)};
    swing.duration = swing_duration(upsilon, from, swing.to);
    trace(upsilon, direction, swing);
    time += swing.duration;
    from = {swing.to, 0};
    swings_.push_back(std::move(swing));
  }
  stick_time_ = time;
  stick_angle_ = from.angle;
}

double ExactPendulum::angle_at(double time) const {
  if (time >= stick_time_) return stick_angle_;
  auto swing = swings_.begin();
  while (time >= swing->start + swing->duration) ++swing;
  const double part = swing->duration / kParts;
  const double at = (time - swing->start) / part;
  const auto i = std::min<std::size_t>(static_cast<std::size_t>(at), kParts - 1);
  const double s = at - static_cast<double>(i), r = 1 - s;
  // cubic of Hermite
  return r * r * ((1 + 2 * s) * swing->angle[i] + s * part * swing->rate[i]) +
         s * s * ((1 + 2 * r) * swing->angle[i + 1] - r * part * swing->rate[i + 1]);
}

}  // namespace erard::study
