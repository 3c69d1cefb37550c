// The whole pipeline between a message and a force: in faults, in recovery, in play.
#include "erard/haptics/renderer.hpp"

#include <array>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "support/device.hpp"
#include "support/heap_calls.hpp"

namespace erard {
namespace {

using test::Device;

constexpr double kT = 5e-4;  // [s]
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kRounding = 1e-9;  // [N] of forces below 100 N, some sums

const ActionFile& action() {
  static const ActionFile loaded = test::grand_action();
  return loaded;
}

/// A key held down by 3 N: the device before the fault.
Device pressed(RenderSettings settings = test::exact_rendering()) {
  Device device(action(), settings);
  device.rest(0.1);
  for (double y = 0; y < 0.0103; y += 5e-5) device.play(y);
  device.rest(0.3, 0.0103);
  return device;
}

double key_height(const Device& device) {
  const Keyboard& keyboard = device.renderer.keyboard();
  return key_position(keyboard.mechanism(0).model, keyboard.state(0));
}

TEST(Renderer, PassesTheForceOfTheSimulationToTheBitWhenAllIsWell) {
  Device device(action(), test::exact_rendering());
  device.rest(0.1);
  const Keystroke piano = test::keystroke("piano");
  for (double t = 0; t < piano.end(); t += kT) {
    const KeyOutput& key = device.play(piano.at(t).value);
    ASSERT_EQ(key.force, key.simulated_force) << t;
    ASSERT_TRUE(key.faults == Fault::none || key.faults == Fault::step_not_converged) << t;  // a statistic
  }
}

TEST(Renderer, IsTheKeyboardWithTheSamePistonToTheBit) {
  RenderSettings settings = test::exact_rendering();
  settings.passivity.is_on = false;
  Device device(action(), settings);
  Model model = action().model;
  Keyboard keyboard(model, 1, settings.tick, settings.sleep);  // the default coupling is that of the action file
  const Keystroke forte = test::keystroke("forte");
  for (double t = -0.1; t < forte.end(); t += kT) {
    const KeyOutput& key = device.play(forte.at(t).value);
    ASSERT_EQ(key.simulated_force, keyboard.tick(std::span(&key.piston, 1))[0]) << t;
  }
}

TEST(Renderer, TellsTheBlowOfTheHammer) {
  for (const char* name : {"piano", "forte"}) {
    const Keystroke keystroke = test::keystroke(name);
    const test::Stroke offline = test::play(action(), keystroke);
    const Event& event = *offline.find(EventKind::hammer_meets_string);
    Device device(action(), test::exact_rendering());
    device.rest(0.1);
    std::vector<HammerEvent> blows;
    for (double t = 0; t < keystroke.end(); t += kT)
      for (const HammerEvent& blow : device.send({keystroke.at(t).value}).blow) blows.push_back(blow);
    ASSERT_EQ(blows.size(), 1u) << name;
    EXPECT_EQ(blows[0].key, 0);
    // a causal input against a spline: docs/validation.md has 2 mm/s at most; and it is a period late
    EXPECT_NEAR(blows[0].speed, event.hammer_speed, 0.004) << name;
    EXPECT_NEAR(blows[0].time - 0.1, event.time + kT, kT) << name;
  }
}

TEST(Renderer, SilenceFadesTheForceToZeroAndRecoversWithoutAReset) {
  Device device = pressed();
  const double height = key_height(device), force = device.play(0.0103).force;
  ASSERT_GT(force, 2);
  const RenderSettings& settings = device.renderer.settings();
  double silent = 0, last = force;
  for (; last > 0 && silent < 1; silent += kT) {
    const KeyOutput& key = device.silence().key[0];
    // no more than the fade may take a period, of the force of the moment
    EXPECT_LE(last - key.force, force * kT / settings.guard.fade_time + kRounding);
    EXPECT_EQ(has(key.faults, Fault::no_input), silent >= settings.watch.timeout - kT / 2) << silent;
    last = key.force;
  }
  EXPECT_NEAR(silent, settings.watch.timeout + settings.guard.fade_time, 3 * kT);
  for (int i = 0; i < 600; ++i) EXPECT_EQ(device.silence().key[0].force, 0);  // 300 ms
  EXPECT_NEAR(key_height(device), height, 1e-6);                              // nobody moved the mechanism

  last = 0;
  double back = 0;
  for (; device.play(0.0103).fade < 1 && back < 1; back += kT) {
    const double now = device.renderer.keyboard().forces()[0];
    EXPECT_NEAR(now, force, 0.01 * force);  // the key still lies there
  }
  EXPECT_NEAR(back, settings.watch.recovery_samples * kT + settings.guard.fade_time, 3 * kT);
  EXPECT_NEAR(device.play(0.0103).force, force, 0.01 * force);
}

TEST(Renderer, AfterAPauseOfTheHostTheForceBeginsAtZeroAndFadesIn) {
  // the device has let go meanwhile: a force as before would be a blow
  Device device = pressed();
  const double force = device.play(0.0103).force;
  ASSERT_GT(force, 2);
  device.pause(0.3);
  const RenderSettings& settings = device.renderer.settings();
  double last = 0, back = 0;
  for (double fade = 0; fade < 1 && back < 1; back += kT) {
    const KeyOutput& key = device.play(0.0103);
    EXPECT_LE(key.force - last, force * 1.01 * kT / settings.guard.fade_time + kRounding);
    last = key.force;
    fade = key.fade;
  }
  EXPECT_NEAR(back, settings.watch.recovery_samples * kT + settings.guard.fade_time, 3 * kT);
  EXPECT_NEAR(last, force, 0.01 * force);
}

TEST(Renderer, KeyThatIsElsewhereAfterASilenceComesBackSoftlyAndWithoutABlow) {
  for (const auto& [from, to] : {std::pair{0.0, 0.010}, std::pair{0.010, 0.0}, std::pair{0.010, 0.005}}) {
    Device device(action(), test::exact_rendering());
    device.rest(0.1);
    for (int i = 0; i <= 4000; ++i) device.play(from * i / 4000);  // slowly: no blow
    for (int i = 0; i < 600; ++i) device.silence();                // 300 ms
    int blows = 0, periods = 0;
    double last = 0;
    bool was_realigned = false;
    while (periods < 4000) {
      const PeriodOutput& out = device.send({to});
      blows += static_cast<int>(out.blow.size());
      was_realigned |= has(out.key[0].faults, Fault::realigned);
      EXPECT_LE(std::abs(out.key[0].force - last), 1) << periods;  // 3 N fade in over 40 periods
      last = out.key[0].force;
      ++periods;
      if (out.key[0].fade == 1) break;
    }
    EXPECT_EQ(blows, 0) << from << " " << to;
    EXPECT_TRUE(was_realigned);
    // the way at 20 mm/s, and what is said of the fade, the watch and the last tenths of a millimetre
    EXPECT_LT(periods * kT, std::abs(to - from) / 0.02 + 0.12);
    EXPECT_NEAR(device.play(to).piston.value, to, 1.1e-4);
  }
}

TEST(Renderer, AJumpWhileThePublisherIsAliveFadesAndComesBack) {
  Device device = pressed();
  double last = device.play(0.0103).force;
  bool was_implausible = false, was_off = false;
  int blows = 0;
  for (int i = 0; i < 3000; ++i) {
    const PeriodOutput& out = device.send({0.004});
    was_implausible |= has(out.faults, Fault::implausible_speed);
    was_off |= out.key[0].force == 0;
    EXPECT_LE(std::abs(out.key[0].force - last), 1);
    last = out.key[0].force;
    blows += static_cast<int>(out.blow.size());
  }
  EXPECT_TRUE(was_implausible);
  EXPECT_TRUE(was_off);
  EXPECT_EQ(blows, 0);
  EXPECT_EQ(device.play(0.004).fade, 1);
  EXPECT_NEAR(device.play(0.004).piston.value, 0.004, 1e-4);
}

TEST(Renderer, ABadKeyIsWithoutInputAndItsNeighboursDoNotNotice) {
  const auto play = [](double bad) {
    Device device(action(), test::exact_rendering(3));
    const Keystroke piano = test::keystroke("piano");
    std::vector<double> forces;
    for (int i = 0; i < 1000; ++i) {
      const double y = piano.at(i * kT - 0.1).value;
      const PeriodOutput& out = device.send({y, i > 300 && i < 600 ? bad : y, 0.9 * y});
      forces.push_back(out.key[0].force);
      forces.push_back(out.key[2].force);
      if (i == 450 && !std::isfinite(bad)) {
        EXPECT_TRUE(has(out.key[1].faults, Fault::not_finite_input));
        EXPECT_TRUE(has(out.key[1].faults, Fault::no_input));
        EXPECT_EQ(out.key[1].force, 0);
        EXPECT_EQ(out.key[0].faults, Fault::none);
      }
    }
    return forces;
  };
  const std::vector<double> clean = play(0.001), with_nan = play(kNan), with_huge = play(1e308);
  EXPECT_EQ(clean, with_nan);
  EXPECT_EQ(clean, with_huge);
}

TEST(Renderer, OfSeveralMessagesInAPeriodTheNewestCounts) {
  const auto play = [](bool is_bundled) {
    Device device(action(), test::exact_rendering());
    device.rest(0.1);
    const std::array<double, 3> position{0, 1e-5, 2e-5};
    std::vector<PositionMessage> messages;
    for (std::size_t i = 0; i < position.size(); ++i)
      messages.push_back({1, device.sequence + static_cast<std::int64_t>(i), device.time() + static_cast<int>(i),
                          std::span(&position[i], 1)});
    if (is_bundled)
      std::swap(messages[1], messages[2]);  // the last to arrive was overtaken: it does not count
    else
      messages.assign(1, messages[2]);
    const PeriodOutput& out = device.renderer.period({device.time() + 150'000, messages});
    EXPECT_EQ(out.used, is_bundled ? &messages[1] : &messages[0]);
    EXPECT_EQ(has(out.message, Fault::reordered), is_bundled);
    EXPECT_EQ(has(out.message, Fault::gap), true);  // one was overtaken, or two never came
    return out.key[0].piston.value;
  };
  EXPECT_EQ(play(true), play(false));
}

TEST(Renderer, ASecondPublisherChangesNoBitWhileTheFirstIsAlive) {
  const auto play = [](bool is_disturbed) {
    Device device(action(), test::exact_rendering());
    const Keystroke piano = test::keystroke("piano");
    std::vector<double> forces;
    for (int i = 0; i < 1000; ++i) {
      if (is_disturbed && i % 10 == 5) {  // its message takes the place of one that comes a period later, with the next
        const double nonsense = 0.008;
        const PositionMessage foreign{99, 1, device.time(), std::span(&nonsense, 1)};
        EXPECT_EQ(device.period(&foreign).message, Fault::foreign_publisher);
      } else if (i % 10 == 5) {
        device.silence();
      } else {
        forces.push_back(device.play(piano.at(i * kT - 0.1).value).force);
      }
    }
    return forces;
  };
  EXPECT_EQ(play(true), play(false));
}

TEST(Renderer, ARestartedPublisherIsHeardAgain) {
  Device device = pressed();
  for (int i = 0; i < 100; ++i) device.silence();
  device.publisher = 77;
  device.sequence = 1;
  device.rest(0.1, 0.0103);
  EXPECT_EQ(device.play(0.0103).fade, 1);
  EXPECT_GT(device.play(0.0103).force, 2);
}

TEST(Renderer, ALostMessageCostsAThirdOfWhatStandingStillWouldCost) {
  const Keystroke piano = test::keystroke("piano");
  const auto play = [&](double extrapolation, bool loses) {
    RenderSettings settings = test::exact_rendering();
    settings.track.extrapolation = extrapolation;
    Device device(action(), settings);
    std::mt19937 random(7);
    std::vector<double> forces;
    device.rest(0.1);
    for (double t = 0; t < piano.end(); t += kT) {
      const bool is_lost = loses && random() % 50 == 0;
      const std::vector<double> position{piano.at(t).value};
      if (is_lost) ++device.sequence;
      forces.push_back((is_lost ? device.silence() : device.send(position)).key[0].simulated_force);
    }
    return forces;
  };
  const auto rms = [](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(a.size()));
  };
  const std::vector<double> all = play(1e-3, false);
  const double guessed = rms(play(1e-3, true), all), stood = rms(play(0, true), all);
  EXPECT_GT(stood, 0.3);  // [N] it does matter
  EXPECT_LT(guessed, stood / 3);
}

TEST(Renderer, AStepThatIsNotFiniteFadesAndKeepsTheLastGoodState) {
  RenderSettings settings = test::exact_rendering();
  settings.passivity.reserve = 1e-9;  // soon used up: then the coupling is one that cannot be computed with
  settings.passivity.safe_coupling.stiffness = HUGE_VAL;
  Device device(action(), settings);
  device.rest(0.1);
  int periods = 0;  // since the first that was not finite
  double at_first = 0, height = 0;
  for (int i = 0; i < 1000; ++i) {
    const double height_before = key_height(device), force_before = at_first;
    const KeyOutput& key = device.play(1e-5 * i);
    ASSERT_TRUE(std::isfinite(key.force));
    if (!has(key.faults, Fault::step_not_finite)) {
      ASSERT_EQ(periods, 0);
      at_first = key.force;
      continue;
    }
    if (periods++ == 0) height = height_before;
    EXPECT_EQ(key_height(device), height);
    EXPECT_LE(key.force, force_before);
  }
  ASSERT_GT(periods, 100);
  EXPECT_GT(at_first, 0.1);  // [N] there was something to fade
  EXPECT_EQ(device.play(0.01).force, 0);
}

/// Messages as no device should send them; the same for the same seed.
class Nonsense {
 public:
  explicit Nonsense(unsigned seed) : random_(seed) {}
  const PeriodOutput& period(Device& device) {
    const auto dice = random_() % 100;
    for (double& p : positions_) {
      y_ += 1e-4 * (static_cast<double>(random_() % 201) / 100 - 1);
      p = std::clamp(y_, -0.002, 0.012);
    }
    if (dice < 3) positions_[random_() % 2] = kNan;
    if (dice == 4) positions_[random_() % 2] = 1e308;
    if (dice == 5) y_ = random_() % 2 == 0 ? 0.0 : 0.010;
    if (dice == 6) silent_ = static_cast<int>(random_() % 40);
    if (dice == 7) device.sequence -= 3;
    if (dice == 8) device.sequence += 1'000'000'000'000;
    if (dice == 9) device.publisher = random_() % 3;
    if (silent_ > 0) return --silent_, device.silence();
    return device.send(positions_);
  }

 private:
  std::mt19937 random_;
  std::vector<double> positions_ = std::vector<double>(2);
  double y_ = 0;
  int silent_ = 0;
};

TEST(Renderer, WhateverComesTheForceIsFiniteWithinItsLimitsAndNeverTooQuick) {
  for (const DriveKind drive : {DriveKind::piston, DriveKind::key}) {
    RenderSettings settings;
    settings.keys = 2;
    settings.tick.drive = drive;
    Device device(action(), settings);
    Nonsense nonsense(11);
    std::array<double, 2> last{};
    for (int i = 0; i < 4000; ++i) {
      const PeriodOutput& out = nonsense.period(device);
      for (std::size_t k = 0; k < 2; ++k) {
        const double force = out.key[k].force;
        ASSERT_LE(std::abs(force), settings.guard.max_force);
        ASSERT_LE(std::abs(force - last[k]), settings.guard.max_slew * kT + kRounding);
        ASSERT_LE(std::abs(out.key[k].current), settings.actuator.voice_coil.max_current);
        last[k] = force;
      }
    }
    for (const Fault seen : {Fault::gap, Fault::reordered, Fault::not_finite_input, Fault::out_of_range,
                             Fault::implausible_speed, Fault::no_input, Fault::foreign_publisher, Fault::realigned})
      EXPECT_GT(device.renderer.counters()[seen], 0);
  }
}

TEST(Renderer, SameInputsGiveTheSameBits) {
  Device one(action(), [] {
    RenderSettings settings;
    settings.keys = 2;
    return settings;
  }());
  Device other(action(), one.renderer.settings());
  Nonsense nonsense(5), again(5);
  for (int i = 0; i < 3000; ++i) {
    const PeriodOutput &a = nonsense.period(one), &b = again.period(other);
    ASSERT_EQ(a.faults, b.faults);
    for (std::size_t k = 0; k < 2; ++k) {
      const std::array<double, 6> x{a.key[k].force,        a.key[k].current,     a.key[k].expected_force,
                                    a.key[k].piston.value, a.key[k].piston.rate, a.key[k].surplus},
          y{b.key[k].force,        b.key[k].current,     b.key[k].expected_force,
            b.key[k].piston.value, b.key[k].piston.rate, b.key[k].surplus};
      ASSERT_EQ(std::memcmp(x.data(), y.data(), sizeof x), 0) << i;
    }
  }
}

TEST(Renderer, TellsWhenMoreKeysAreAwakeThanItsStepBudgetIsFor) {
  RenderSettings settings = test::exact_rendering();
  settings.keys = 3;
  settings.sleep = SleepSettings::eager();
  settings.max_steps_per_s = 10 / kT;  // one key with two steps, each tried and split in four
  Device device(action(), settings);
  EXPECT_TRUE(has(device.send({0, 0, 0}).faults, Fault::coarser_steps));  // nobody sleeps yet
  while (device.renderer.keyboard().asleep_count() < 3) device.send({0, 0, 0});
  for (double y = 0; y < 0.01; y += 1e-4) ASSERT_FALSE(has(device.send({y, 0, 0}).faults, Fault::coarser_steps)) << y;
  bool is_told = false;
  for (double y = 0; y < 0.01; y += 1e-4) is_told |= has(device.send({0.01, y, 0}).faults, Fault::coarser_steps);
  EXPECT_TRUE(is_told);
}

TEST(Renderer, MakesNoHeapCall) {
  RenderSettings settings;
  settings.keys = 2;
  Device device(action(), settings);
  const std::array<double, 2> down{0.009, kNan}, up{0.0, 0.0};
  device.period(nullptr);
  const long before = heap_calls;
  for (std::int64_t i = 0; i < 4000; ++i) {
    const PositionMessage message{1, i, device.time(), i / 400 % 2 == 0 ? up : down};
    device.period(i % 700 > 650 ? nullptr : &message);
  }
  EXPECT_EQ(heap_calls, before);
}

TEST(Renderer, KeysAtRestSleepUnderTheNoiseOfTheirSensor) {
  RenderSettings settings;
  settings.keys = 8;
  Device device(action(), settings);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, settings.passivity.sensor_noise);
  std::vector<double> positions(8);
  int awake = 0;
  for (int i = 0; i < 6000; ++i) {
    for (std::size_t k = 0; k < 8; ++k) positions[k] = (k < 4 ? 0.0 : 0.009) + noise(random);
    const int asleep = device.send(positions).asleep;
    if (i >= 5000) awake += 8 - asleep;
  }
  EXPECT_EQ(awake, 0);
}

TEST(Renderer, TheBrakeIsNeverAskedToPush) {
  RenderSettings settings = test::exact_rendering();
  settings.actuator.kind = ActuatorKind::mr_brake;
  Device device(action(), settings);
  device.rest(0.1);
  const Keystroke forte = test::keystroke("forte");
  bool was_asked = false;
  for (double t = 0; t < forte.end(); t += kT) {
    const KeyOutput& key = device.play(forte.at(t).value);
    EXPECT_GE(key.current, 0);
    if (key.force > 0 && key.piston.rate < -settings.actuator.mr_brake.standstill_speed) {
      EXPECT_EQ(key.current, 0);
      was_asked |= has(key.faults, Fault::cannot_push);
    }
  }
  EXPECT_TRUE(was_asked);  // the key pushes the finger up on its way back
}

}  // namespace
}  // namespace erard
