// The virtual device against what can be said of it exactly.
#include "erard/device/rig.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "erard/device/intended_motion.hpp"

namespace erard {
namespace {

constexpr double kSubStep = 2.5e-5;  // [s]

Keystroke constant(double position) { return {KeystrokeQuantity::position, {0, 1}, {position, position}}; }
Keystroke nobody() { return constant(-1); }  // the finger a metre above

/// A bare mass: no friction, no lag, no noise.
RigSettings bare(double mass = 0.1) {
  RigSettings settings;
  settings.lever = {mass, 0, 0, 0, 0, 10};
  settings.sensor = {0, 0, 0, 1};
  settings.actuator = {VirtualActuatorKind::voice_coil, 0, 0, 100, 0};
  settings.finger = {1000, 0};
  settings.sub_step = kSubStep;
  return settings;
}

TEST(Rig, FreeMassFallsAlongItsParabola) {
  Rig rig(bare(0.1), nobody());
  rig.advance(0.2, -3);
  EXPECT_NEAR(rig.state().lever.position, 3 / 0.1 * 0.2 * 0.2 / 2, 1e-12);  // rounding of 8000 steps
  EXPECT_NEAR(rig.state().lever.velocity, 3 / 0.1 * 0.2, 1e-12);
}

TEST(Rig, SwingsOnTheFingerWithThePeriodOfMassAndStiffness) {
  // pressed from both sides, so that the finger stays on: about 4 mm, from 0 to 8 mm, finger at 10 mm
  const double k = 1000, m = 0.1, X = 0.01, push = 6;
  Rig rig(bare(m), constant(X));
  const double period = 2 * std::numbers::pi * std::sqrt(m / k);
  const double middle = X - push / k;
  const auto energy = [&] {
    const Motion& lever = rig.state().lever;
    return m * lever.velocity * lever.velocity / 2 + k * std::pow(lever.position - middle, 2) / 2;
  };
  const double start = energy();
  double worst = 0;
  // the trapezoidal rule keeps the amplitude and swings with 2/h atan(w h / 2), slower by (w h)^2 / 12 = 5e-7 here
  const double slowed = 2 / kSubStep * std::atan(std::sqrt(k / m) * kSubStep / 2);
  EXPECT_NEAR(slowed, std::sqrt(k / m), 1e-6 * std::sqrt(k / m));
  const int steps = static_cast<int>(std::lround(10 * period / kSubStep));
  double off = 0;
  for (int i = 1; i <= steps; ++i) {
    rig.advance(kSubStep, push);
    worst = std::max(worst, std::abs(energy() / start - 1));
    off = std::max(off, std::abs(rig.state().lever.position - middle * (1 - std::cos(i * kSubStep * slowed))));
  }
  EXPECT_LT(off, 1e-10);    // rounding, 25000 steps of 4 mm
  EXPECT_LT(worst, 1e-10);  // it keeps the energy of a spring but for rounding
}

TEST(Rig, DampedFingerComesToItsBalance) {
  RigSettings settings = bare();
  settings.finger = {1000, 20};  // critical: 2 sqrt(k m) = 20
  Rig rig(settings, constant(0.01));
  rig.advance(0.5, 4);
  EXPECT_NEAR(rig.state().lever.position, 0.006, 1e-12);  // e^-50 of 6 mm
  EXPECT_NEAR(rig.state().finger_force, 4, 1e-9);
}

TEST(Rig, FingerNeverPulls) {
  RigSettings settings = bare();
  settings.finger = {1000, 20};
  // down 8 mm and up again in 20 ms each: the lever, thrown down, is left behind
  Rig rig(settings, repeated_notes(0.008, 20, 1, 0.02, 0));
  bool has_left = false;
  for (int i = 0; i < 2000; ++i) {
    rig.advance(kSubStep, 0);
    EXPECT_GE(rig.state().finger_force, 0);
    if (rig.state().finger_force == 0 && rig.state().lever.velocity > 0) has_left = true;
  }
  EXPECT_TRUE(has_left);
  const double speed = rig.state().lever.velocity;
  rig.advance(0.01, 0);
  EXPECT_EQ(rig.state().lever.velocity, speed);  // nothing acts on it
}

TEST(Rig, SticksWithEveryBitUpToTheDryFriction) {
  RigSettings settings = bare();
  settings.lever.dry_friction = 0.5;
  Rig rig(settings, nobody());
  rig.advance(0.01, -2);  // away from the stop
  rig.advance(0.1, 0);    // comes to rest
  ASSERT_EQ(rig.state().lever.velocity, 0);
  const double place = rig.state().lever.position;
  for (const double push : {0.5 - 1e-12, -0.5 + 1e-12, 0.0}) {
    rig.advance(0.1, push);
    EXPECT_EQ(rig.state().lever.position, place) << push;
  }
  rig.advance(0.01, -0.5 - 1e-6);
  EXPECT_NEAR(rig.state().lever.velocity, 1e-6 / 0.1 * 0.01, 1e-15);
}

TEST(Rig, SlidesAsFarAsDryFrictionLetsIt) {
  RigSettings settings = bare();
  settings.lever.dry_friction = 0.5;
  Rig rig(settings, nobody());
  rig.advance(0.01, -2.5);  // 20 m/s^2
  const Motion from = rig.state().lever;
  rig.advance(0.1, 0);
  EXPECT_EQ(rig.state().lever.velocity, 0);
  // v^2 / 2a with a = c / m; the last step is cut short by at most h^2 a / 8
  const double deceleration = 0.5 / 0.1;
  EXPECT_NEAR(rig.state().lever.position - from.position, from.velocity * from.velocity / (2 * deceleration),
              kSubStep * kSubStep * deceleration / 8 + 1e-12);
}

TEST(Rig, LosesEnergyToFrictionAndDampingInEveryStep) {
  RigSettings settings = bare(0.06);
  settings.lever = {0.06, 0.1, 0.5, 0, 0, 10};
  settings.finger = {2000, 3};
  const double X = 0.01;
  Rig rig(settings, constant(X));
  const auto energy = [&] {
    const Motion& lever = rig.state().lever;
    const double press = std::max(0.0, X - lever.position);
    return 0.06 * lever.velocity * lever.velocity / 2 + 2000 * press * press / 2;
  };
  double before = energy();
  for (int i = 0; i < 40000; ++i) {
    rig.advance(kSubStep, 0);
    ASSERT_LE(energy(), before + 1e-15) << i;  // rounding of 0.1 J
    before = energy();
  }
  EXPECT_LT(before, 1e-4);
}

TEST(Rig, StaysOnTheStopThatItMeets) {
  RigSettings settings = bare();
  settings.lever.depth = 0.01;
  Rig rig(settings, nobody());
  for (int i = 0; i < 10000; ++i) {
    rig.advance(kSubStep, i < 5000 ? -1 : 1);
    EXPECT_LE(rig.state().lever.position, 0.01);
    EXPECT_GE(rig.state().lever.position, 0);
    if (i < 4000 || i >= 5000) continue;
    EXPECT_EQ(rig.state().lever.position, 0.01);
    EXPECT_EQ(rig.state().lever.velocity, 0);
  }
  EXPECT_EQ(rig.state().lever.position, 0);
  EXPECT_EQ(rig.state().lever.velocity, 0);
}

TEST(Rig, ReturnSpringLiftsTheLever) {
  RigSettings settings = bare();
  settings.lever = {0.1, 0.2, 0, 0.3, 20, 0.01};
  Rig rig(settings, nobody());
  rig.advance(0.05, -3);
  ASSERT_GT(rig.state().lever.position, 0.005);
  rig.advance(1, 0);
  EXPECT_EQ(rig.state().lever.position, 0);
}

TEST(VoiceCoil, AnswersWithItsTimeConstantExactly) {
  VirtualActuator coil({VirtualActuatorKind::voice_coil, 0.0003, 0, 10, 0}, kSubStep);
  for (int i = 1; i <= 40; ++i) {
    const ActuatorLoad load = coil.advance(4);
    const auto force = [](double t) { return 4 * (1 - std::exp(-t / 0.0003)); };
    EXPECT_NEAR(coil.force(), force(i * kSubStep), 1e-13);
    // Simpson's rule of the exact force, to (h / tau)^4 / 2880 of 4 N
    const double mean = (force((i - 1) * kSubStep) + 4 * force((i - 0.5) * kSubStep) + force(i * kSubStep)) / 6;
    EXPECT_NEAR(load.push, mean, 1e-7);
    EXPECT_EQ(load.grip, 0);
  }
}

TEST(VoiceCoil, KeepsItsLimitInBothDirections) {
  for (const double command : {50., -50.}) {
    VirtualActuator coil({VirtualActuatorKind::voice_coil, 0.0003, 0, 10, 0}, kSubStep);
    for (int i = 0; i < 1000; ++i) EXPECT_LE(std::abs(coil.advance(command).push), 10);
    EXPECT_NEAR(coil.force(), command > 0 ? 10 : -10, 1e-12);
  }
}

TEST(VirtualActuator, DeadTimeIsExact) {
  for (const VirtualActuatorKind kind : {VirtualActuatorKind::voice_coil, VirtualActuatorKind::mr_brake}) {
    VirtualActuator actuator({kind, 0, 0.0005, 10, 0}, kSubStep);
    for (int i = 0; i < 20; ++i) {
      actuator.advance(3);
      EXPECT_EQ(actuator.force(), 0) << i;
    }
    actuator.advance(3);
    EXPECT_EQ(actuator.force(), 3);
  }
}

RigSettings braked() {
  RigSettings settings = bare();
  settings.actuator = {VirtualActuatorKind::mr_brake, 0.002, 0, 20, 0.1};
  return settings;
}

TEST(MrBrake, NeverMovesWhatRests) {
  Rig rig(braked(), nobody());
  for (int i = 0; i < 1000; ++i) {
    rig.advance(5e-4, 20 * std::sin(0.1 * i));
    EXPECT_EQ(rig.state().lever.position, 0);
    EXPECT_EQ(rig.state().lever.velocity, 0);
  }
}

TEST(MrBrake, NeverHastensWhatMovesAndNeverTurnsIt) {
  RigSettings settings = braked();
  settings.actuator.off_drag = 0;
  Rig rig(settings, press_and_hold(0.01, 0, 0.02, 0));
  rig.advance(0.02, 0);  // thrown by the finger, which stops at 10 mm
  while (rig.state().finger_force > 0) rig.advance(kSubStep, 0);
  double speed = rig.state().lever.velocity;
  ASSERT_GT(speed, 0.1);
  for (int i = 0; i < 4000; ++i) {
    rig.advance(kSubStep, 8 * std::sin(0.01 * i));
    EXPECT_LE(rig.state().lever.velocity, speed);
    EXPECT_GE(rig.state().lever.velocity, 0);
    speed = rig.state().lever.velocity;
  }
  EXPECT_EQ(speed, 0);
}

TEST(MrBrake, HoldsAFingerUpToItsGripAndItsDrag) {
  for (const double surplus : {-1e-6, 1e-3}) {
    RigSettings settings = braked();
    const double grip = 5.1;  // command and off-state drag
    Rig rig(settings, constant((grip + surplus) / settings.finger.stiffness));
    RigSettings gripped = settings;
    gripped.actuator.time_constant = 0;
    Rig at_once(gripped, constant((grip + surplus) / settings.finger.stiffness));
    at_once.advance(0.5, 5);
    EXPECT_EQ(at_once.state().lever.position > 0, surplus > 0) << surplus;
    rig.advance(0.5, 5);  // the fluid needs milliseconds, in which the finger sinks
    EXPECT_GT(rig.state().lever.position, 1e-4);
    EXPECT_EQ(rig.state().lever.velocity, 0);
  }
}

TEST(VirtualSensor, DelayIsExact) {
  VirtualSensor sensor({0, 0, 0.001, 1}, kSubStep);
  for (int i = 1; i <= 200; ++i) {
    sensor.follow(0.1 * i);
    EXPECT_EQ(sensor.measure(), i > 40 ? 0.1 * (i - 40) : 0);
  }
}

TEST(VirtualSensor, GivesTheNearestCount) {
  const double count = 2e-6;
  VirtualSensor sensor({count, 0, 0, 1}, kSubStep);
  for (int i = 0; i < 100; ++i) {
    const double position = 1e-3 + i * 0.37e-6;
    sensor.follow(position);
    const double sample = sensor.measure();
    EXPECT_LE(std::abs(sample - position), count / 2 * (1 + 1e-9));  // rounding of the division
    EXPECT_NEAR(sample / count, std::round(sample / count), 1e-9);
  }
}

TEST(VirtualSensor, NoiseIsThatOfItsSeedAndHasItsDeviation) {
  VirtualSensor one({0, 50e-6, 0, 7}, kSubStep), same({0, 50e-6, 0, 7}, kSubStep), other({0, 50e-6, 0, 8}, kSubStep);
  double sum = 0, square = 0, product = 0, before = 0;
  int equal = 0;
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const double sample = one.measure();
    EXPECT_EQ(sample, same.measure());
    equal += sample == other.measure() ? 1 : 0;
    sum += sample;
    square += sample * sample;
    product += sample * before;
    before = sample;
  }
  EXPECT_EQ(equal, 0);
  // five standard errors: of a mean s / sqrt(n), of a deviation s / sqrt(2 n), of a correlation 1 / sqrt(n)
  EXPECT_NEAR(sum / count, 0, 5 * 50e-6 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(square / count), 50e-6, 5 * 50e-6 / std::sqrt(2.0 * count));
  EXPECT_NEAR(product / square, 0, 5 / std::sqrt(count));
}

TEST(Rig, RepeatsBitForBitHoweverItsTimeIsCut) {
  RigSettings settings;
  settings.lever.mass = 0.06;
  const Keystroke notes = repeated_notes(0.01, 5, 2, 0.03, 0.05);
  Rig one(settings, notes), other(settings, notes);
  for (int period = 0; period < 800; ++period) {
    const double command = 500 * one.measure();
    EXPECT_EQ(command, 500 * other.measure());
    one.advance(5e-4, command);
    for (int i = 0; i < 5; ++i) other.advance(1e-4, command);
    ASSERT_EQ(one.state().lever.position, other.state().lever.position) << period;
    ASSERT_EQ(one.state().finger_force, other.state().finger_force);
  }
  EXPECT_GT(one.state().time, 0.4 - 1e-9);
}

TEST(Rig, KeepsTheRestOfATimeThatIsNotWholeSubSteps) {
  Rig rig(bare(), nobody());
  for (int i = 0; i < 3000; ++i) rig.advance(kSubStep / 3, 0);
  EXPECT_NEAR(rig.state().time, 1000 * kSubStep, 1e-12);
}

TEST(Rig, RefusesWhatCannotBe) {
  const auto with = [](auto change) {
    RigSettings settings = bare();
    change(settings);
    return Rig(settings, nobody());
  };
  EXPECT_THROW(with([](RigSettings& s) { s.lever.mass = 0; }), std::invalid_argument);
  EXPECT_THROW(with([](RigSettings& s) { s.lever.dry_friction = -1; }), std::invalid_argument);
  EXPECT_THROW(with([](RigSettings& s) { s.sensor.noise = std::nan(""); }), std::invalid_argument);
  EXPECT_THROW(with([](RigSettings& s) { s.sensor.delay = 1; }), std::invalid_argument);
  EXPECT_THROW(with([](RigSettings& s) { s.actuator.limit = -1; }), std::invalid_argument);
  EXPECT_THROW(with([](RigSettings& s) { s.sub_step = 0; }), std::invalid_argument);
  EXPECT_THROW(Rig(bare(), Keystroke(KeystrokeQuantity::force, {0, 1}, {0, 1})), std::invalid_argument);
}

TEST(IntendedMotion, PressesWithLeastJerkAndHolds) {
  const Keystroke press = press_and_hold(0.01, 0.1, 0.2, 0.3);
  EXPECT_NEAR(press.at(0.05).value, 0, 1e-12);
  EXPECT_NEAR(press.at(0.2).value, 0.005, 1e-8);               // half-way in the middle
  EXPECT_NEAR(press.at(0.2).rate, 0.01 / 0.2 * 15 / 8, 1e-6);  // the top speed of least jerk
  EXPECT_NEAR(press.at(0.5).value, 0.01, 1e-12);
  EXPECT_EQ(press.at(9).rate, 0);
  EXPECT_NEAR(press.end(), 0.6, 1e-12);
  EXPECT_THROW(press_and_hold(0.01, 0, 0, 1), std::invalid_argument);
}

TEST(IntendedMotion, RepeatsItsNotes) {
  const Keystroke notes = repeated_notes(0.01, 4, 3, 0.04, 0.05);
  EXPECT_NEAR(notes.end(), 0.75, 1e-12);
  for (int n = 0; n < 3; ++n) {
    EXPECT_NEAR(notes.at(n * 0.25 + 0.065).value, 0.01, 1e-9) << n;
    EXPECT_NEAR(notes.at(n * 0.25 + 0.020).value, 0.005, 1e-7) << n;
    EXPECT_NEAR(notes.at(n * 0.25 + 0.200).value, 0, 1e-9) << n;
  }
  EXPECT_THROW(repeated_notes(0.01, 10, 1, 0.04, 0.05), std::invalid_argument);
}

}  // namespace
}  // namespace erard
