// What actuators can do and cannot.
#include "erard/haptics/actuator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace erard {
namespace {

constexpr double kT = 5e-4;  // [s]

struct Coil {
  ActuatorCommand command(double force) {
    faults = Fault::none;
    return coil.command(settings, kT, force, faults);
  }
  VoiceCoilSettings settings;
  VoiceCoil coil;
  Fault faults = Fault::none;
};

TEST(VoiceCoil, CurrentIsForceOverItsConstantInEitherDirection) {
  Coil coil;
  for (const double force : {4.0, -4.0, 0.0, 20.0}) {
    const ActuatorCommand command = coil.command(force);
    EXPECT_DOUBLE_EQ(command.current, force / coil.settings.force_constant);
    EXPECT_DOUBLE_EQ(command.force, force);
    EXPECT_EQ(coil.faults, Fault::none);
  }
}

TEST(VoiceCoil, NeverAsksForMoreThanTheLargestCurrent) {
  Coil coil;
  for (const double force : {100.0, -100.0}) {
    const ActuatorCommand command = coil.command(force);
    EXPECT_EQ(std::abs(command.current), coil.settings.max_current);
    EXPECT_EQ(command.force, std::copysign(24.0, force));  // 8 N/A times 3 A
    EXPECT_EQ(coil.faults, Fault::current_limited);
  }
}

TEST(VoiceCoil, WarmsAsAFirstOrderLagOfTheSquareOfTheCurrent) {
  Coil coil;
  const double current = 0.5;
  for (int i = 0; i < 60000; ++i) coil.command(current * coil.settings.force_constant);  // 30 s: one time constant
  // explicit Euler over T / tau = 2e-5 errs by that share at most
  EXPECT_NEAR(coil.coil.heat(), 0.25 * -std::expm1(-1.0), 0.25 * 2e-5);
  for (int i = 0; i < 60000; ++i) coil.command(0);
  EXPECT_NEAR(coil.coil.heat(), 0.25 * -std::expm1(-1.0) * std::exp(-1.0), 0.25 * 4e-5);
}

TEST(VoiceCoil, FoldsBackToTheContinuousCurrentAndNeverOverheats) {
  Coil coil;
  double hottest = 0;
  bool was_thermal = false;
  for (int i = 0; i < 300000; ++i) {  // two and a half minutes at the limit
    coil.command(24);
    hottest = std::max(hottest, coil.coil.heat());
    was_thermal |= coil.faults == Fault::thermal_limited;
  }
  EXPECT_TRUE(was_thermal);
  EXPECT_LE(hottest, 1);
  EXPECT_NEAR(coil.command(24).current, coil.settings.continuous_current, 1e-2);
}

TEST(VoiceCoil, AMinuteOfFortissimoRepetitionsIsNotHeldBack) {
  // twelve blows a second of 20 N for 10 ms, held by 3 N: rms 7.5 N, 0.94 A of the 1 A that the winding stands for ever
  Coil coil;
  for (int i = 0; i < 120000; ++i) {
    const double phase = std::fmod(i * kT, 1.0 / 12);
    coil.command(phase < 0.010 ? 20 : 3);
    ASSERT_EQ(coil.faults, Fault::none) << i * kT << " s";
  }
  EXPECT_GT(coil.coil.heat(), 0.5);  // it was a load
}

struct Brake {
  ActuatorCommand command(double force, double velocity) {
    faults = Fault::none;
    return brake.command(settings, kT, force, velocity, faults);
  }
  /// After the response has settled.
  ActuatorCommand settled(double force, double velocity) {
    for (int i = 0; i < 1000; ++i) command(force, velocity);
    return command(force, velocity);
  }
  MrBrakeSettings settings;
  MrBrake brake;
  Fault faults = Fault::none;
};

constexpr double kSettled = 1e-9;  // [N] a thousand periods of a tenth of the response time

TEST(MrBrake, MakesTheWantedForceAgainstTheMotion) {
  Brake brake;
  for (const double force : {0.5, 3.0, 20.0}) {
    const ActuatorCommand down = brake.settled(force, 0.1);
    EXPECT_NEAR(down.force, force, kSettled);
    const ActuatorCommand up = brake.settled(-force, -0.1);
    EXPECT_NEAR(up.force, -force, kSettled);
    EXPECT_EQ(up.current, down.current);
    EXPECT_GT(down.current, 0);
  }
}

TEST(MrBrake, CurrentIsZeroWhereItWouldHaveToPush) {
  Brake brake;
  for (const double force : {3.0, -3.0}) {
    brake.settled(force, force > 0 ? 0.1 : -0.1);
    const ActuatorCommand command = brake.command(force, force > 0 ? -0.1 : 0.1);
    EXPECT_EQ(command.current, 0);
    EXPECT_TRUE(has(brake.faults, Fault::cannot_push));
  }
}

TEST(MrBrake, NeverGivesEnergy) {
  Brake brake;
  for (int i = 0; i < 20000; ++i) {
    const double velocity = 0.3 * std::sin(0.013 * i), force = 12 * std::sin(0.0071 * i);
    const ActuatorCommand command = brake.command(force, velocity);
    EXPECT_GE(command.current, 0);
    if (std::abs(velocity) > brake.settings.standstill_speed) {
      EXPECT_GT(command.force * velocity, 0);
    }
  }
}

TEST(MrBrake, DragsWithoutCurrent) {
  Brake brake;
  const ActuatorCommand command = brake.settled(0, 0.1);
  EXPECT_EQ(command.current, 0);
  EXPECT_NEAR(command.force, brake.settings.drag, kSettled);
}

TEST(MrBrake, HoldsAtStandstillUpToItsYield) {
  Brake brake;
  EXPECT_NEAR(brake.settled(5, 0).force, 5, kSettled);
  EXPECT_GT(brake.command(5, 0).current, 0);
  // all it has: drag and the yield at its largest current
  const double all = 0.3 + 25 * -std::expm1(-2 / 0.8);
  EXPECT_NEAR(brake.settled(40, 0).force, all, kSettled);
  EXPECT_TRUE(has(brake.faults, Fault::current_limited));
}

TEST(MrBrake, AnswersWithItsResponseTime) {
  Brake brake;
  const int periods = static_cast<int>(std::lround(brake.settings.response_time / kT));
  double force = 0;
  for (int i = 0; i < periods; ++i) force = brake.command(10, 0.1).force;
  // exact for a current that is held: 63 % of the way from the drag after one time constant
  EXPECT_NEAR(force, 0.3 + (10 - 0.3) * -std::expm1(-1.0), kSettled);
}

TEST(Actuator, WithoutAModelTheForceIsWhatWasWanted) {
  Actuator actuator;
  Fault faults = Fault::none;
  const ActuatorCommand command = actuator.command({ActuatorKind::none, {}, {}}, kT, 12.5, -0.1, faults);
  EXPECT_EQ(command.force, 12.5);
  EXPECT_EQ(command.current, 0);
  EXPECT_EQ(faults, Fault::none);
}

}  // namespace
}  // namespace erard
