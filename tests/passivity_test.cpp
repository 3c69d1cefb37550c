// The joint between device and action: what it may take, and what happens when it makes energy.
#include "erard/haptics/passivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/device.hpp"

namespace erard {
namespace {

constexpr double kT = 5e-4;  // [s]

PassivitySettings bare() {
  PassivitySettings settings;
  settings.device_damping = 0;
  settings.loop_delay = 0;
  settings.sensor_noise = 0;
  return settings;
}

/// A joint, and what it is told.
struct Joint {
  explicit Joint(const PassivitySettings& s) : settings(s) { passivity.restart(settings, 0); }

  /// A period in which the force that acts is told of first.
  bool period(double force, double way, double given = 0, double stored = 0, bool is_let_go = false) {
    passivity.remember(force);
    passivity.observe(settings, kT, 0, {way, given, stored});
    return passivity.act(settings, kT, is_let_go);
  }
  PassivitySettings settings;
  Passivity passivity;
};

TEST(Passivity, ActsWhenTheReserveIsUsedUpAndNotBefore) {
  Joint joint(bare());  // reserve 2 mJ; -1 N over 0.1 mm makes 0.1 mJ
  for (int i = 1; i <= 19; ++i) EXPECT_FALSE(joint.period(-1, 1e-4)) << i;
  EXPECT_NEAR(joint.passivity.surplus(), 1e-4, 1e-12);  // sums of twenty
  joint.period(-1, 0.5e-4);
  EXPECT_FALSE(joint.passivity.is_acting());
  EXPECT_TRUE(joint.period(-1, 1e-4));
}

TEST(Passivity, CreditDoesNotGrowBeyondTheReserve) {
  Joint joint(bare());
  for (int i = 0; i < 10000; ++i) joint.period(1, 1e-4);
  EXPECT_EQ(joint.passivity.surplus(), joint.settings.reserve);
  int periods = 1;
  while (!joint.period(-1, 1e-4)) ++periods;
  EXPECT_LE(periods, 21);
}

TEST(Passivity, EnergyThatTheSpringKeepsIsNoCreditAndGivingItBackNoDebt) {
  Joint joint(bare());
  const double a = 6500;
  double stretch = 0;
  for (int i = 0; i < 1000; ++i) {
    const double next = 1e-3 * std::sin(0.05 * (i + 1)), mean = a * (stretch + next) / 2;
    if (next < 0) break;
    joint.period(mean, next - stretch, 0, a / 2 * next * next);  // mean force times way is d(stored), exactly
    stretch = next;
    EXPECT_NEAR(joint.passivity.surplus(), joint.settings.reserve, 1e-12);
  }
}

TEST(Passivity, EnergyThatGoesOnToTheKeyIsNotMissed) {
  Joint joint(bare());
  for (int i = 0; i < 1000; ++i) joint.period(3, 1e-4, 3e-4);
  EXPECT_NEAR(joint.passivity.surplus(), joint.settings.reserve, 1e-12);
}

TEST(Passivity, TakesTheForceThatActedNotTheOneAskedForLast) {
  for (const double delay : {0.0, 0.5, 1.0, 2.25, 6.0}) {
    PassivitySettings settings = bare();
    settings.loop_delay = delay * kT;
    Joint joint(settings);
    const auto asked = [](double i) { return i < 0 ? 0.0 : 1.0 + std::fmod(7 * i, 5); };  // of whole i
    for (int i = 0; i < 30; ++i) {
      const double before = joint.passivity.surplus();
      joint.period(asked(i), -1e-6);
      const double whole = std::floor(delay), part = delay - whole;
      const double acting = (1 - part) * asked(i - whole) + part * asked(i - whole - 1);
      EXPECT_NEAR(before - joint.passivity.surplus(), acting * 1e-6, 1e-15) << delay << " " << i;
    }
  }
}

TEST(Passivity, StaysForItsHoldTimeAndUntilTheKeyIsLetGo) {
  Joint joint(bare());
  ASSERT_TRUE(joint.period(-100, 1e-3));
  const int hold = static_cast<int>(joint.settings.hold_time / kT);
  for (int i = 1; i < hold; ++i) EXPECT_TRUE(joint.period(0, 0, 0, 0, true)) << i;
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(joint.period(1, 0, 0, 0, false));
  EXPECT_FALSE(joint.period(0, 0, 0, 0, true));
}

TEST(Passivity, DampingOfTheDeviceCounts) {
  PassivitySettings settings = bare();
  settings.device_damping = 2;  // [N s/m]
  Joint joint(settings);
  joint.period(-100, 1e-5);  // debt of 1 mJ
  const double before = joint.passivity.surplus();
  joint.period(0, 1e-4);
  EXPECT_NEAR(joint.passivity.surplus() - before, 2 * 1e-8 / kT, 1e-15);
}

// ---- in the pipeline

using test::Device;

RenderSettings exact() {
  RenderSettings settings = test::exact_rendering();
  settings.passivity.sensor_noise = 0;
  return settings;
}

TEST(PassivityOfTheDevice, DoesNotActInStrokesPlayedIdeally) {
  const ActionFile action = test::grand_action();
  for (const char* name : {"piano", "forte", "repetition"})
    for (const double delay : {0.0, 5e-4, 1e-3}) {
      RenderSettings settings = exact();
      settings.passivity.loop_delay = delay;
      Device device(action, settings);
      const Keystroke keystroke = test::keystroke(name);
      double least = settings.passivity.reserve;
      device.rest(0.1);
      for (double t = 0; t < keystroke.end(); t += kT) {
        const KeyOutput& key = device.play(keystroke.at(t).value);
        EXPECT_FALSE(has(key.faults, Fault::passivity_acted)) << name << " " << t;
        least = std::min(least, key.surplus);
      }
      // three quarters of the reserve stay untouched: what strokes cost is told in docs/device.md
      EXPECT_GT(least, 0.75 * settings.passivity.reserve) << name << " " << delay;
    }
}

TEST(PassivityOfTheDevice, NoiseOfTheSensorOnAKeyHeldDownIsNoGeneratedEnergy) {
  RenderSettings settings = exact();
  settings.passivity.sensor_noise = 5e-6;
  settings.track.still_zone = 0;  // or the piston would stand
  settings.passivity.loop_delay = 0;
  Device device(test::grand_action(), settings);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 5e-6);
  device.rest(0.1);
  for (double y = 0; y < 0.0103; y += 5e-5) device.play(y);
  int acted = 0;
  for (int i = 0; i < 4000; ++i) acted += has(device.play(0.0103 + noise(random)).faults, Fault::passivity_acted);
  EXPECT_EQ(acted, 0);
}

/// A lever of 60 g, without damping or friction, pressed onto the key bottom by a force that grows to 10 N within 0.2 s
/// and stays; what the renderer asks for acts one period later and is held for a period.
struct Lever {
  double position = 0, rate = 0, fastest = 0;  // fastest: of the last second
  bool has_acted = false;
};
Lever press_onto_the_bottom(bool is_on) {
  constexpr int kSubsteps = 20;
  constexpr double kMass = 0.06, kStop = 2e4, h = kT / kSubsteps;
  RenderSettings settings = exact();
  settings.track.estimator.length = 2;  // the backward difference
  settings.track.estimator.degree = 1;
  settings.passivity.is_on = is_on;
  settings.passivity.device_damping = 0;
  settings.passivity.loop_delay = kT;
  settings.passivity.safe_coupling = {2000, 25};  // 10 N through it press the lever 5 mm deeper, not 20
  settings.track.still_zone = 0;
  settings.guard.max_force = 1e3;  // no limit may help
  settings.guard.max_slew = 1e9;
  Device device(test::grand_action(), settings);
  Lever lever;
  double acting = 0;
  for (int i = 0; i < 4000; ++i) {
    const KeyOutput& key = device.play(std::clamp(lever.position, -0.0029, 0.0159));
    lever.has_acted |= has(key.faults, Fault::passivity_acted);
    const double finger = 10 * std::clamp((i * kT - 0.1) / 0.2, 0.0, 1.0);
    for (int j = 0; j < kSubsteps; ++j) {
      const double stop = lever.position < 0 ? -kStop * lever.position - 20 * lever.rate : 0.0;
      lever.rate += h / kMass * (finger + stop - acting);
      lever.position += h * lever.rate;
      if (i >= 2000) lever.fastest = std::max(lever.fastest, std::abs(lever.rate));
    }
    acting = key.expected_force;
  }
  return lever;
}

TEST(PassivityOfTheDevice, CalmsALeverThatTheCouplingOfTheThesisShakes) {
  const Lever shaken = press_onto_the_bottom(false);
  EXPECT_FALSE(shaken.has_acted);
  EXPECT_GT(shaken.fastest, 0.1);  // [m/s], for ever: the case is one
  const Lever calm = press_onto_the_bottom(true);
  EXPECT_TRUE(calm.has_acted);
  EXPECT_LT(calm.fastest, 1e-3);    // a hundredth of the other
  EXPECT_GT(calm.position, 0.010);  // on the bottom still
}

TEST(PassivityOfTheDevice, ASafeCouplingThatIsTheUsualOneChangesNoBit) {
  const ActionFile action = test::grand_action();
  const auto play = [&](bool is_on) {
    RenderSettings settings = exact();
    settings.sleep.is_on = false;
    settings.passivity.is_on = is_on;
    settings.passivity.reserve = 1e-9;
    settings.passivity.safe_coupling = settings.coupling;
    Device device(action, settings);
    const Keystroke forte = test::keystroke("forte");
    std::vector<double> forces;
    bool has_acted = false;
    device.rest(0.1);
    for (double t = 0; t < forte.end(); t += kT) {
      const KeyOutput& key = device.play(forte.at(t).value);
      forces.push_back(key.force);
      has_acted |= has(key.faults, Fault::passivity_acted);
    }
    EXPECT_EQ(has_acted, is_on);
    return forces;
  };
  EXPECT_EQ(play(true), play(false));
}

TEST(PassivityOfTheDevice, AddsDampingWhereTheKeyIsDriven) {
  RenderSettings settings = exact();
  settings.tick.drive = DriveKind::key;
  settings.passivity.reserve = 1e-9;
  Device device(test::grand_action(), settings);
  device.rest(0.1);
  bool has_acted = false;
  for (int i = 1; i < 40; ++i) {
    const KeyOutput& key = device.play(1e-4 * i);  // 0.2 m/s
    if (!has(key.faults, Fault::passivity_acted)) continue;
    has_acted = true;
    const double damping = settings.passivity.safe_coupling.damping * key.piston.rate;
    // the gate may hold back by its slew limit alone
    if (!has(key.faults, Fault::slew_limited)) {
      EXPECT_NEAR(key.force, key.simulated_force + damping, 1e-12);
    }
  }
  EXPECT_TRUE(has_acted);
}

}  // namespace
}  // namespace erard
