// What leaves is finite, limited, never too quick, and fades.
#include "erard/haptics/guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace erard {
namespace {

constexpr double kT = 5e-4;         // [s]
constexpr double kRounding = 1e-9;  // [N] forces of 20 N, forty sums
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Gate {
  double pass(double wanted, bool is_well = true) {
    faults = Fault::none;
    return guard.pass(settings, kT, wanted, is_well, faults);
  }
  void open(double wanted) {
    while (guard.fade() < 1) pass(wanted);
  }
  GuardSettings settings;
  Guard guard;
  Fault faults = Fault::none;
};

TEST(Guard, PassesAForceWithinItsLimitsToTheBit) {
  Gate gate;
  gate.open(3.0);
  for (int i = 0; i < 100; ++i) {
    const double wanted = 3 + 2 * std::sin(0.1 * i);
    EXPECT_EQ(gate.pass(wanted), wanted);
    EXPECT_EQ(gate.faults, Fault::none);
  }
}

TEST(Guard, FadesInAndOutInTheFadeTime) {
  Gate gate;
  const int periods = static_cast<int>(std::lround(gate.settings.fade_time / kT));
  double last = 0;
  for (int i = 1; i <= periods; ++i) {
    EXPECT_NEAR(gate.pass(10), 10.0 * i / periods, kRounding);
    EXPECT_GE(gate.guard.force(), last);
    last = gate.guard.force();
  }
  EXPECT_EQ(gate.pass(10), 10);
  for (int i = 1; i <= periods; ++i) EXPECT_NEAR(gate.pass(10, false), 10.0 * (periods - i) / periods, kRounding);
  EXPECT_EQ(gate.pass(10, false), 0);
}

TEST(Guard, FadesToZeroWithinTheSlewLimit) {
  Gate gate;
  gate.settings.max_slew = 500;  // [N/s], slower than the fade of 20 N in 20 ms
  gate.open(20);
  for (int i = 0; i < 1000; ++i) gate.pass(20);
  double last = gate.guard.force();
  ASSERT_EQ(last, 20);
  int periods = 0;
  for (; gate.guard.force() > 0; ++periods) {
    gate.pass(20, false);
    EXPECT_LE(last - gate.guard.force(), gate.settings.max_slew * kT + kRounding);
    last = gate.guard.force();
  }
  EXPECT_NEAR(periods * kT, 20 / 500.0, 2 * kT);
}

TEST(Guard, LimitsEitherSignAndSaysSo) {
  Gate gate;
  gate.open(0);
  for (int i = 0; i < 100; ++i) gate.pass(1e300);
  EXPECT_EQ(gate.guard.force(), gate.settings.max_force);
  EXPECT_TRUE(has(gate.faults, Fault::force_limited));
  for (int i = 0; i < 100; ++i) gate.pass(-1e300);
  EXPECT_EQ(gate.guard.force(), -gate.settings.max_force);
  gate.pass(19.9);
  EXPECT_FALSE(has(gate.faults, Fault::force_limited));
}

TEST(Guard, WhatIsNotFiniteCountsAsTheLastGoodForceAndFades) {
  Gate gate;
  gate.open(8);
  EXPECT_EQ(gate.pass(8), 8);
  for (const double bad : {kNan, HUGE_VAL, -HUGE_VAL}) {
    const double before = gate.guard.force();
    gate.pass(bad);
    EXPECT_TRUE(has(gate.faults, Fault::step_not_finite));
    EXPECT_NEAR(before - gate.guard.force(), 8 * kT / gate.settings.fade_time, kRounding);
  }
  for (int i = 0; i < 100; ++i) gate.pass(kNan);
  EXPECT_EQ(gate.guard.force(), 0);
  gate.open(8);
  EXPECT_EQ(gate.pass(8), 8);  // and comes back
}

TEST(Guard, HoldsItsLimitsWhateverComes) {
  Gate gate;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double last = 0;
  for (int i = 0; i < 100000; ++i) {
    const double dice = uniform(random);
    const double wanted = dice > 0.9 ? kNan : dice > 0.8 ? 1e308 : dice > 0.7 ? -HUGE_VAL : 50 * uniform(random);
    const double force = gate.pass(wanted, uniform(random) > -0.5);
    ASSERT_LE(std::abs(force), gate.settings.max_force);
    ASSERT_LE(std::abs(force - last), gate.settings.max_slew * kT + kRounding);
    last = force;
  }
}

}  // namespace
}  // namespace erard
