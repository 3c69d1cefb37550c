#include "study/pendulum.hpp"

#include <chrono>
#include <cmath>

namespace erard::study {

double mean_error(const PendulumScheme& scheme, const PendulumCase& c, const ExactPendulum& exact) {
  const long count = static_cast<long>(kPendulumPeriods) * c.steps;
  double sum = 0;
  const bool is_converged = run_pendulum(scheme, c, count, [&](long k, const PendulumState& state) {
    sum += std::abs(state.angle - exact.angle_at(static_cast<double>(k) / c.steps));
  });
  return is_converged ? sum / static_cast<double>(count + 1) : NAN;
}

StepsNeeded steps_needed(const PendulumScheme& scheme, PendulumCase c, double tolerance, int limit) {
  const ExactPendulum exact(c.upsilon, c.start);
  StepsNeeded needed;
  for (c.steps = 5; c.steps <= limit; c.steps += std::max(1, c.steps / 100)) {
    // not a number counts as missed
    const bool is_reached = mean_error(scheme, c, exact) <= tolerance;
    if (is_reached && needed.first == 0) needed.first = c.steps;
    if (!is_reached)
      needed.lasting = 0;
    else if (needed.lasting == 0)
      needed.lasting = c.steps;
  }
  return needed;
}

PendulumRest rest_of(const PendulumScheme& scheme, const PendulumCase& c) {
  constexpr long kMinute = 60;
  const long begin = static_cast<long>(kPendulumPeriods) * c.steps;
  PendulumRest rest;
  const bool is_converged = run_pendulum(scheme, c, begin + kMinute * c.steps, [&](long k, const PendulumState& state) {
    if (k == begin) rest.angle = state.angle;
    if (k < begin) return;
    rest.fastest = std::max(rest.fastest, std::abs(state.rate));
    rest.drift = state.angle - rest.angle;
  });
  if (!is_converged) rest = {NAN, NAN, NAN};
  return rest;
}

double final_angle(const PendulumScheme& scheme, const PendulumCase& c) {
  double angle = 0;
  const bool is_converged = run_pendulum(scheme, c, static_cast<long>(kPendulumPeriods) * c.steps,
                                         [&](long, const PendulumState& state) { angle = state.angle; });
  return is_converged ? angle : NAN;
}

double explicit_spectral_radius(const PendulumCase& c) {
  const double h = 1.0 / c.steps;
  const double half_trace = 1 - 0.5 * h * c.upsilon * c.upsilon * c.psi;
  const double determinant = 2 * half_trace - 1 + h * h * kPendulumGravity;
  const double discriminant = half_trace * half_trace - determinant;
  return discriminant < 0 ? std::sqrt(determinant) : std::abs(half_trace) + std::sqrt(discriminant);
}

double explicit_growth_threshold(const PendulumCase& c) {
  return 2 * c.upsilon * c.upsilon / kPendulumGravity / std::expm1(M_PI * M_PI / c.steps);
}

namespace {

/// Computing time of so many steps and of what goes before the first [s].
double seconds_of(const PendulumScheme& scheme, const PendulumCase& c, long count) {
  using Clock = std::chrono::steady_clock;
  double best = INFINITY;
  for (int i = 0; i < 50; ++i) {
    double sum = 0;  // so that the states are needed
    const auto start = Clock::now();
    run_pendulum(scheme, c, count, [&](long, const PendulumState& state) { sum += state.angle; });
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (std::isfinite(sum)) best = std::min(best, seconds);
  }
  return best;
}

}  // namespace

double seconds_per_step(const PendulumScheme& scheme, const PendulumCase& c) {
  const long count = static_cast<long>(kPendulumPeriods) * c.steps;
  return (seconds_of(scheme, c, count) - seconds_of(scheme, c, 0)) / static_cast<double>(count);
}

}  // namespace erard::study
