// The models of chapter 2 against closed forms, and Table 2.1 against Table 2.2.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "study/simple_key.hpp"

using namespace erard;
using namespace erard::study::simple;

namespace {

constexpr double kArm = 0.245;  // [m]
constexpr double kFar = 10;     // an angle that is never reached [rad]

/// A body without stops.
SimpleAction one_body(const OneBody& body) {
  SimpleAction action;
  action.arm = kArm;
  action.key = body;
  action.rail = {kArm, kFar, 1.6e10, 2.7, 2e9};
  return action;
}

Keystroke constant_force(double force) { return {KeystrokeQuantity::force, {0, 10}, {force, force}}; }

std::vector<double> instants(double end, double spacing) {
  std::vector<double> times;
  for (int i = 0; i <= std::lround(end / spacing); ++i) times.push_back(i * spacing);
  return times;
}

/// Largest difference of the angle from a function of time.
template <typename Function>
double largest_error(const KeyMotion& motion, const Function& exact) {
  double largest = 0;
  for (std::size_t i = 0; i < motion.time.size(); ++i)
    largest = std::max(largest, std::abs(motion.angle[i] - exact(motion.time[i])));
  return largest;
}

/// SK on its way to a punching at 0.01 rad, at 1 rad/s, without other moments.
SimpleAction thrown_at(const Punching& rail) {
  SimpleAction action = one_body({0.0221, 0, 0, 0, 0});
  action.rail = rail;
  return action;
}

double deepest(const KeyMotion& motion) { return *std::max_element(motion.angle.begin(), motion.angle.end()); }

}  // namespace

// ---- time stepping

TEST(OneBody, UniformMomentGivesTheParabola) {
  const SimpleAction action = one_body({0.0221, 0, 0.01, 0.1, 0});
  const double acceleration = (kArm * 2 - 0.1 - 0.01) / 0.0221;
  const KeyMotion motion = move(action, constant_force(2), instants(0.05, 5e-4));
  // the scheme is exact for a uniform moment, friction included: rounding of 1000 steps
  EXPECT_LT(largest_error(motion, [&](double t) { return acceleration * t * t / 2; }), 1e-15);
}

TEST(OneBody, ViscousLossGivesTheExponentialToSecondOrder) {
  const SimpleAction action = one_body({0.0221, 0.3, 0, 0, 0});
  const double rate = 0.3 / 0.0221;  // [1/s]
  const KeyStart start{0, 0.01, 1};
  const auto exact = [&](double t) { return 0.01 + (1 - std::exp(-rate * t)) / rate; };
  const auto error = [&](double step) {
    return largest_error(move(action, constant_force(0), instants(0.2, 1e-2), start, step), exact);
  };
  // local error of the midpoint rule (c h / J)^2 / 12, of a path of 1 / rate
  EXPECT_LT(error(1e-3), rate * 1e-6 / 12);
  EXPECT_NEAR(error(1e-3) / error(5e-4), 4, 0.1);
}

TEST(OneBody, BlockedHammerSwingsAtItsOwnFrequency) {
  const OneBody blocked = thesis_action().blocked;
  const SimpleAction action = one_body({blocked.inertia, 0, 0, -blocked.stiffness * 0.01, blocked.stiffness});
  const double omega = std::sqrt(blocked.stiffness / blocked.inertia);
  const KeyMotion motion = move(action, constant_force(0), instants(0.2, 5e-4), {0, 0.015, 0});
  const double step = 5e-5;
  // relative error of the frequency (omega h)^2 / 24, grown over 0.2 s, times the amplitude
  const double bound = 0.005 * std::pow(omega * step, 2) / 24 * omega * 0.2;
  EXPECT_LT(largest_error(motion, [&](double t) { return 0.01 + 0.005 * std::cos(omega * t); }), 1.1 * bound);
}

TEST(OneBody, DryFrictionTakesTheSameOffEverySwingAndThenHolds) {
  // swings about 0.01 rad with 2 C_d / K less each: 4.6 -> -2.6 -> 0.6 mrad, where friction (1 mrad) holds
  const double K = 60, inertia = 3.36e-3, step = 5e-5;
  const SimpleAction action = one_body({inertia, 0, K * 1e-3, -K * 0.01, K});
  const KeyMotion motion = move(action, constant_force(0), instants(0.3, 5e-4), {0, 0.0146, 0});
  // a turning point is met to half a step's acceleration, K a h^2 / J; two of them
  EXPECT_NEAR(motion.angle.back(), 0.0106, 2 * K * 4.6e-3 * step * step / inertia);
  EXPECT_EQ(motion.rate.back(), 0);
}

TEST(OneBody, RestCarriesTheKey) {
  const SimpleAction action = one_body({0.0221, 0.03, 0.01, 0.13, 0});
  const KeyMotion motion = move(action, constant_force(0.2), instants(0.05, 5e-4), {0, 1e-4, -0.1});
  // it goes through by half a step of the first rate at most
  EXPECT_GT(*std::min_element(motion.angle.begin(), motion.angle.end()), -0.1 * 5e-5);
  EXPECT_EQ(motion.rate.back(), 0);
}

TEST(Punching, StopsTheKeyWhereItsEnergyIsStored) {
  const double k = 1.6e10, r = 2.7, J = 0.0221;
  const KeyMotion motion =
      move(thrown_at({kArm, 0.01, k, r, 0}), constant_force(0), instants(0.01, 1e-5), {0, 0.009, 1}, 1e-5);
  // J w^2 / 2 = k d^(r+1) / (r+1); sampled every 1e-5 s of a contact of 5 ms: (pi 1e-5 / 5e-3)^2 / 2 = 2e-5
  const double depth = std::pow((r + 1) * J / (2 * k), 1 / (r + 1));
  EXPECT_NEAR(kArm * (deepest(motion) - 0.01) / depth, 1, 1e-4);
  EXPECT_NEAR(motion.rate.back(), -1, 1e-4);
}

TEST(Punching, LossAloneStopsTheKeyAtTheCubeRoot) {
  const double b = 2e9, mass = 0.0221 / (kArm * kArm);
  const KeyMotion motion =
      move(thrown_at({kArm, 0.01, 0, 2.7, b}), constant_force(0), instants(0.02, 1e-4), {0, 0.009, 1}, 1e-5);
  // m v' = -b d^2 v: v = v_0 - b d^3 / (3 m). Steps of 1 % of the time m / (b d^2) = 0.7 ms: second order, 1e-4
  EXPECT_NEAR(kArm * (motion.angle.back() - 0.01) / std::cbrt(3 * mass * kArm / b), 1, 1e-3);
}

TEST(Punching, NeverPulls) {
  SimpleAction action = thesis_action();
  KeyMotion lifting{{0}, {action.rail.angle + 1e-3}, {-10}, {0}};  // faster than the felt opens
  const double with_rail = feel(action, lifting).front();
  action.rail.angle = kFar;
  EXPECT_EQ(with_rail, feel(action, lifting).front());
  // nor does it hold back a key that leaves it
  const SimpleAction lossy = thrown_at({kArm, 0.01, 0, 2.7, 2e9});
  EXPECT_EQ(move(lossy, constant_force(0), {0, 5e-4}, {0, 0.011, -10}).rate.back(), -10);
}

TEST(SimpleAction, TakeoverKeepsTheMomentum) {
  SimpleAction action = one_body({0.0221, 0, 0, 0, 0});
  action.blocked = {3.36e-3, 0, 0, 0, 0};
  action.takeover_angle = 0.01;
  const auto last_rate = [&] { return move(action, constant_force(0), {0, 0.05}, {0, 0.005, 0.2}).rate.back(); };
  EXPECT_DOUBLE_EQ(last_rate(), 0.2 * 3.36e-3 / 0.0221);
  action.takeover = Takeover::keeps_velocity;
  EXPECT_DOUBLE_EQ(last_rate(), 0.2);
}

TEST(SimpleAction, ForceOfItsOwnMotionIsTheForceThatMovedIt) {
  SimpleAction action = thesis_action();
  action.takeover_angle = 0;
  std::vector<double> times = instants(0.04, 5e-4), force;
  const double omega = 2 * std::acos(-1) / 0.05;
  for (const double t : times) force.push_back(1.5 + 0.5 * std::sin(omega * t));  // above F_down all the time
  KeyMotion motion = move(action, {KeystrokeQuantity::force, times, force}, times);
  motion.acceleration = differentiate(times, motion.rate);
  const std::vector<double> felt = feel(action, motion);
  // central differences of 0.5 ms lose (omega h)^2 / 6 = 6.6e-4 of the amplitude
  for (std::size_t i = 1; i + 1 < times.size(); ++i) EXPECT_NEAR(felt[i], force[i], 0.5 * 7e-4) << times[i];
}

// ---- Tables 2.1 and 2.2

TEST(SimpleParts, TableTwoOneGivesTableTwoTwo) {
  const Equivalents one = equivalents(thesis_parts());
  const auto within = [](double printed, double computed) { return std::abs(computed / printed - 1); };
  // printed to two or three digits
  EXPECT_LT(within(0.0221, one.inertia), 0.005);
  EXPECT_LT(within(0.132, one.static_weight), 0.005);
  EXPECT_LT(within(0.039, one.dry), 0.01);
  EXPECT_LT(within(0.0273, one.viscous), 0.005);
  EXPECT_LT(within(0.4, one.spring), 0.01);
  EXPECT_LT(within(0.1947, one.spring_rest), 0.005);
  // C_w is not 0.138: -0.0155 + 2.15 * 0.0103 + 10.1176 * 0.0133
  EXPECT_NEAR(one.weight, 0.14121, 1e-5);
}

TEST(SimpleParts, PrintedSpringContradictsTheTouchWeight) {
  const KeyParts parts = thesis_parts();
  const SimpleAction printed = thesis_action_with_printed_spring();
  // F_down of (2.6) at rest against 0.70 N; half as much again is beyond any uncertainty of 0.1 N (Table 3.2)
  EXPECT_GT((printed.key.load + printed.key.dry) / printed.arm, parts.down_force + 3 * 0.1);
}
