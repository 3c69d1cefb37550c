// Many keys: each as if it were alone, asleep or awake, on whichever thread.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "erard/device/key_pool.hpp"
#include "support/heap_calls.hpp"
#include "support/scenes.hpp"

namespace erard {
namespace {

using test::Part;

const SleepSettings kAwake = [] {
  SleepSettings sleep;
  sleep.is_on = false;
  return sleep;
}();
const auto kIgnore = [](int, const State&, const StepReport&, double) noexcept {};

TickSettings settings_of(int internal_steps, DriveKind drive = DriveKind::piston) {
  TickSettings settings;
  settings.drive = drive;
  settings.set_rate(2000, internal_steps);
  return settings;
}

/// Down in 60 ms, up again after 300 ms: a raised cosine each way.
Keystroke press(KeystrokeQuantity quantity, double depth) {
  std::vector<double> times, values;
  for (double t = 0; t <= 0.5; t += 1e-3) {
    const auto rise = [t](double from) { return 0.5 * (1 - std::cos(M_PI * std::clamp((t - from) / 0.06, 0.0, 1.0))); };
    times.push_back(t);
    values.push_back(depth * (rise(0.02) - rise(0.32)));
  }
  return {quantity, times, values};
}

/// One scene on two keyboards, with sleep and without.
struct Scene {
  double worst = 0;  // difference of the force of any key [N]
  long slept = 0;    // periods times keys
};
Scene play(const ActionFile& action, const std::vector<Part>& parts, double duration, const TickSettings& settings,
           const SleepSettings& sleep = {}) {
  const int keys = static_cast<int>(parts.size());
  Keyboard sleepy(action.model, keys, settings, sleep), awake(action.model, keys, settings, kAwake);
  std::vector<DriveSample> inputs;
  Scene scene;
  while (awake.time() < duration) {
    test::sample(parts, awake, inputs);
    const auto forces = sleepy.tick(inputs), truth = awake.tick(inputs);
    for (int k = 0; k < keys; ++k) scene.worst = std::max(scene.worst, std::abs(forces[k] - truth[k]));
    scene.slept += sleepy.asleep_count();
  }
  EXPECT_EQ(awake.asleep_count(), 0);
  return scene;
}

/// Sleep begins at changes of 1e-10 N and less; the promise leaves a decade to what they grow to.
constexpr double kSameForce = 1e-9;  // [N]

class EveryScheme : public testing::TestWithParam<int> {};  // internal steps a period, 0: adaptive, the default
INSTANTIATE_TEST_SUITE_P(Keyboard, EveryScheme, testing::Values(0, 1, 4));

TEST_P(EveryScheme, SleepChangesNoForceOfAnyScene) {
  const ActionFile action = test::grand_action();
  const Keystroke piano = test::keystroke("piano"), forte = test::keystroke("forte");
  const Keystroke repetition = test::keystroke("repetition");
  const TickSettings settings = settings_of(GetParam());
  struct Case {
    const char* name;
    Part part;
    double duration;
    double asleep;  // share of the time, at least; after some strokes the solver itself creeps, and nobody sleeps
  };
  for (const Case& c : {Case{"untouched", {}, 0.5, 0.9}, Case{"strokes and rests", {&piano, 0.1, 1.2}, 2.5, 0.3},
                        Case{"loud strokes and rests", {&forte, 0.1, 1.2}, 2.5, 0.2},
                        Case{"held down and let go at once", {&piano, 0.1, 0.8, 0.15}, 2.5, 0.3},
                        Case{"let go between strokes", {&repetition, 0.1, 1.4}, 3, 0.2},
                        Case{"one after the other", {&forte, 0.0, 0.3}, 1.5, 0}}) {
    const Scene scene = play(action, {c.part}, c.duration, settings);
    EXPECT_LE(scene.worst, kSameForce) << c.name;
    EXPECT_GE(static_cast<double>(scene.slept) * settings.period, c.asleep * c.duration) << c.name;
  }
}

TEST(Keyboard, SleepChangesNoForceOfManyKeys) {
  const Keystroke forte = test::keystroke("forte"), piano = test::keystroke("piano");
  std::vector<Part> parts(12);
  for (std::size_t k = 0; k < parts.size(); k += 2) parts[k] = {k % 4 == 0 ? &forte : &piano, 0.03 * double(k), 1.3};
  const Scene scene = play(test::grand_action(), parts, 2, settings_of(1));
  EXPECT_LE(scene.worst, kSameForce);
  EXPECT_GT(scene.slept, 6 * 3900);  // the six untouched ones, and the others now and then
}

TEST(Keyboard, EagerSleepIsLongerAndStillMovesNoForceByAMicronewton) {
  const ActionFile action = test::grand_action();
  const Keystroke forte = test::keystroke("forte");
  const std::vector<Part> parts{{&forte, 0.1, 1.2}};
  const TickSettings settings = settings_of(4);  // its second rest creeps
  const Scene strict = play(action, parts, 3.6, settings),
              eager = play(action, parts, 3.6, settings, SleepSettings::eager());
  EXPECT_GT(eager.slept, strict.slept + 500);
  EXPECT_LE(eager.worst, 1e-6);
  EXPECT_GT(eager.worst, 0);
}

TEST(Keyboard, SleepChangesNoForceUnderAnyDrive) {
  const ActionFile action = test::grand_action();
  const Keystroke push = press(KeystrokeQuantity::force, 2), motion = press(KeystrokeQuantity::position, 0.0095);
  for (const auto& [drive, keystroke] : {std::pair{DriveKind::force, &push}, {DriveKind::key, &motion}}) {
    const Scene scene = play(action, {Part{keystroke, 0, 1.5}}, 3, settings_of(0, drive));
    EXPECT_LE(scene.worst, kSameForce);
    EXPECT_GT(scene.slept, 500) << name_of(drive);
  }
  EXPECT_EQ(play(action, {Part{&push}}, 1, settings_of(0, DriveKind::none)).worst, 0);
}

TEST(Keyboard, SleepChangesNoForceOfFeltsWithMass) {
  ActionOptions options;
  options.felts = FeltModel::bodies;
  const Keystroke piano = test::keystroke("piano");
  const Scene scene = play(test::grand_action(options), {Part{&piano, 0.1, 1.2}}, 2, settings_of(1));
  EXPECT_LE(scene.worst, kSameForce);
  EXPECT_GT(scene.slept, 500);
}

TEST(Keyboard, EveryPartOfTheStateCountsAgainstRest) {
  const Mechanism mechanism = build_mechanism(test::grand_action().model);
  const SleepSettings sleep;
  const State rest = rest_state(mechanism, 1e-4);
  EXPECT_TRUE(is_still(sleep, rest));
  EXPECT_TRUE(is_same_rest(sleep, rest, rest));
  const auto differs = [&](auto&& change) {
    State other = rest;
    change(other);
    return !is_same_rest(sleep, rest, other) || !is_still(sleep, other);
  };
  for (const double factor : {-2.0, 2.0}) {
    for (int i = 0; i < mechanism.coordinate_count; ++i) {
      EXPECT_TRUE(differs([&](State& s) { s.v[i] = factor * sleep.rate; }));
      // by the last bit of an angle where that is more than the bound
      EXPECT_TRUE(differs([&](State& s) { s.x[i] += factor * std::max(sleep.coordinate, 2e-16 * std::abs(s.x[i])); }));
    }
    for (int k = 0; k < mechanism.rows.count; ++k)
      EXPECT_TRUE(differs([&](State& s) { s.impulse[k] += factor * sleep.reaction * s.time_step; }));
    for (int c = 0; c < mechanism.contact_count(); ++c)
      EXPECT_TRUE(differs([&](State& s) { s.compression[c] += factor * sleep.compression; }));
  }
  EXPECT_TRUE(differs([](State& s) { s.time_step = 2e-4; }));
  EXPECT_TRUE(differs([](State& s) { s.compression[0] = std::numeric_limits<double>::quiet_NaN(); }));
}

TEST(Keyboard, AKeyIsAsIfItWereAlone) {
  const ActionFile action = test::grand_action();
  const Mechanism mechanism = build_mechanism(action.model);
  const Keystroke forte = test::keystroke("forte");
  const TickSettings settings = settings_of(0);
  const std::vector<Part> parts{{}, {&forte, 0.05}, {&forte, 0.02}};
  Keyboard keyboard(action.model, 3, settings, kAwake);
  const auto work = std::make_unique<Workspace>();
  State alone = rest_state(mechanism, settings.scheme.time_step);
  std::vector<DriveSample> inputs;
  DriveSample last;
  for (int i = 0; i < 400; ++i) {
    test::sample(parts, keyboard, inputs);
    const LineInput input{last, inputs[1], keyboard.time(), settings.period};
    alone.time = keyboard.time();
    const double force = tick(mechanism, settings, input, alone, *work, [](auto&&...) noexcept {}).force;
    ASSERT_EQ(keyboard.tick(inputs)[1], force) << i;
    last = inputs[1];
  }
  EXPECT_EQ(keyboard.state(1).x, alone.x);
}

TEST(Keyboard, AKeyThatMovesUnderAConstantInputStaysAwake) {
  const ActionFile action = test::grand_action();
  const Keystroke piano = test::keystroke("piano");
  Keyboard keyboard(action.model, 1, settings_of(0));
  DriveSample input;
  for (; keyboard.time() < 0.2; keyboard.tick({&input, 1})) input = Part{&piano}.at(keyboard.time());
  input = {-0.001, 0};  // the finger is gone at once, the key is still down
  double top = 1;       // [m]
  while (!keyboard.is_asleep(0) && keyboard.time() < 2) {
    keyboard.tick({&input, 1});
    top = key_position(keyboard.mechanism(0).model, keyboard.state(0));
  }
  EXPECT_TRUE(keyboard.is_asleep(0));
  EXPECT_LT(top, 5e-4);  // it slept up here, not on the way: 9.5 mm of it
  EXPECT_EQ(keyboard.forces()[0], 0);
}

TEST(Keyboard, AHeldKeySleepsAndKeepsItsForce) {
  const ActionFile action = test::grand_action();
  const Keystroke piano = test::keystroke("piano");
  Keyboard keyboard(action.model, 1, settings_of(0));
  const Part part{&piano, 0, 10, 0.15};
  std::vector<DriveSample> inputs;
  const auto run_until = [&](double end) {
    while (keyboard.time() < end) test::sample({part}, keyboard, inputs), keyboard.tick(inputs);
  };
  run_until(0.5);
  const double force = keyboard.forces()[0];
  EXPECT_TRUE(keyboard.is_asleep(0));
  EXPECT_GT(force, 1);
  run_until(0.6);
  EXPECT_EQ(keyboard.forces()[0], force);
  inputs[0].value += 1e-6;  // a micrometre more
  keyboard.tick(inputs);
  EXPECT_FALSE(keyboard.is_asleep(0));
  // the key sticks to rail and felts: about the stiffness of the finger, a = 6500 N/m, alone
  EXPECT_NEAR(keyboard.forces()[0] - force, 6.5e-3, 3e-3);
}

TEST(Keyboard, APistonInTheAirWakesNobodyUntilItTouches) {
  const ActionFile action = test::grand_action();
  Keyboard sleepy(action.model, 1, settings_of(0)), awake(action.model, 1, settings_of(0), kAwake);
  DriveSample input;
  for (int i = 0; i < 100; ++i) sleepy.tick({&input, 1}), awake.tick({&input, 1});
  ASSERT_TRUE(sleepy.is_asleep(0));
  for (int i = 1; i <= 400; ++i) {  // up by 2 mm and down on the key, at rates up to 30 mm/s
    const double phase = 2 * M_PI * i / 400;
    input = {-1e-3 * (1 - std::cos(phase)), -1e-3 * 2 * M_PI * 5 * std::sin(phase)};
    const double force = sleepy.tick({&input, 1})[0];
    ASSERT_EQ(force, awake.tick({&input, 1})[0]) << i;
    // a Y + b Y' <= 0
    ASSERT_EQ(sleepy.is_asleep(0), 6500 * input.value + 134 * input.rate < -1e-9) << i;
    if (force > 0) break;
  }
  EXPECT_GT(sleepy.forces()[0], 0);
}

TEST(Keyboard, AFingerThatFallsOnASleeperIsFeltAsIfItHadBeenAwake) {
  const ActionFile action = test::grand_action();
  Keyboard sleepy(action.model, 1, settings_of(0)), awake(action.model, 1, settings_of(0), kAwake);
  const auto both = [&](const DriveSample& input) {
    return std::abs(sleepy.tick({&input, 1})[0] - awake.tick({&input, 1})[0]);
  };
  for (int i = 0; i < 100; ++i) both({-1e-3 * i / 100, 0});  // goes up to 1 mm, and stays there
  both({-1e-3, 0});
  ASSERT_TRUE(sleepy.is_asleep(0));
  for (int i = 0; i < 60; ++i) EXPECT_LE(both({std::min(-1e-3 + 2e-4 * i, 6e-3), i < 35 ? 0.4 : 0}), kSameForce) << i;
  EXPECT_FALSE(sleepy.is_asleep(0));
}

TEST(Keyboard, ManyTremblingFingersInTheAirLeaveAllKeysAsleep) {
  Keyboard keyboard(test::grand_action().model, 4, settings_of(1));
  std::vector<DriveSample> inputs(4);
  for (int i = 0; i < 200; ++i) {
    for (std::size_t k = 0; k < 4; ++k)
      inputs[k] = {-1e-3 + 1e-5 * std::sin(double(i) + double(k)), 1e-3 * std::cos(i)};
    keyboard.tick(inputs);
  }
  EXPECT_EQ(keyboard.asleep_count(), 4);
}

TEST(Keyboard, TimeGoesOnForThoseAsleep) {
  Keyboard keyboard(test::grand_action().model, 2, settings_of(0));
  const std::vector<DriveSample> inputs(2);
  for (int i = 0; i < 1000; ++i) keyboard.tick(inputs);
  ASSERT_EQ(keyboard.asleep_count(), 2);
  EXPECT_EQ(keyboard.time(), 1000 * 5e-4);
  EXPECT_EQ(keyboard.state(1).time, keyboard.time());
}

TEST(Keyboard, InputThatIsNotFiniteConcernsItsOwnKeyAlone) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    Keyboard keyboard(test::grand_action().model, 2, settings_of(0));
    std::vector<DriveSample> inputs(2);
    for (int i = 0; i < 100; ++i) keyboard.tick(inputs);
    ASSERT_EQ(keyboard.asleep_count(), 2);
    const State before = keyboard.state(0);
    inputs[0].value = bad;
    keyboard.tick(inputs);
    EXPECT_EQ(keyboard.statuses()[0], StepStatus::not_finite);
    EXPECT_EQ(keyboard.statuses()[1], StepStatus::converged);
    EXPECT_EQ(keyboard.state(0).x, before.x);
    EXPECT_FALSE(keyboard.is_asleep(0));
    EXPECT_TRUE(keyboard.is_asleep(1));
    inputs[0] = {};
    keyboard.tick(inputs);
    EXPECT_EQ(keyboard.statuses()[0], StepStatus::converged);  // from the last good input on
    for (int i = 0; i < 50; ++i) keyboard.tick(inputs);
    EXPECT_EQ(keyboard.statuses()[0], StepStatus::converged);
    EXPECT_TRUE(keyboard.is_asleep(0));
  }
}

/// Hammers of 9 to 12.5 g, one model for two keys.
std::vector<Model> graded_models() {
  std::vector<Model> models;
  for (const double mass : {0.009, 0.0105, 0.0125}) {
    ActionOptions options;
    options.settings = {{"m_H", mass}};
    models.push_back(test::grand_action(options).model);
  }
  return models;
}
const std::vector<int> kModelOfKey{0, 0, 1, 1, 2, 2};

TEST(Keyboard, GradedKeysPlayEachTheirOwnAction) {
  const std::vector<Model> models = graded_models();
  const Keystroke forte = test::keystroke("forte");
  const TickSettings settings = settings_of(0);
  Keyboard keyboard(models, kModelOfKey, settings);
  std::vector<Keyboard> single;
  for (const Model& model : models) single.emplace_back(model, 1, settings);
  std::vector<DriveSample> inputs;
  double spread = 0;
  for (int i = 0; i < 300; ++i) {
    test::sample(std::vector<Part>(6, Part{&forte}), keyboard, inputs);
    const auto forces = keyboard.tick(inputs);
    for (std::size_t k = 0; k < 6; k += 2) ASSERT_EQ(forces[k], single[k / 2].tick({&inputs[k], 1})[0]) << i;
    spread = std::max(spread, std::abs(forces[0] - forces[5]));
  }
  EXPECT_GT(spread, 0.1);  // [N] heavier hammers are felt
  EXPECT_EQ(&keyboard.mechanism(0), &keyboard.mechanism(1));
  EXPECT_NE(&keyboard.mechanism(0), &keyboard.mechanism(2));
}

TEST(Keyboard, SharesInAnyOrderOnPoisonedScratchChangeNoBit) {
  const std::vector<Model> models = graded_models();
  const Keystroke forte = test::keystroke("forte");
  const TickSettings settings = settings_of(0);
  constexpr int kBudget = 30;  // for three keys; four are played, at times
  Keyboard whole(models, kModelOfKey, settings, {}, kBudget), shared(models, kModelOfKey, settings, {}, kBudget);
  std::vector<Part> parts(6);
  for (std::size_t k = 0; k < 4; ++k) parts[k] = {&forte, 0.01 * double(k), 0.5};
  const auto work = std::make_unique<Workspace>();
  std::vector<DriveSample> inputs;
  for (int i = 0; i < 1200; ++i) {
    test::sample(parts, whole, inputs);
    whole.tick(inputs);
    shared.begin_tick(inputs);
    for (int share = 3; share >= 0; --share) {
      // all bits set: NaN in every double, absurd sizes in every matrix
      std::memset(static_cast<void*>(work.get()), 0xff, sizeof(Workspace));
      shared.tick_share(share, 4, inputs, *work, kIgnore);
    }
    shared.end_tick();
    for (std::size_t k = 0; k < 6; ++k) ASSERT_EQ(whole.forces()[k], shared.forces()[k]) << i;
  }
  for (int k = 0; k < 6; ++k) EXPECT_EQ(whole.state(k).impulse, shared.state(k).impulse);
}

/// Steps in a period of which all keys together took most.
int most_steps(Keyboard& keyboard, const std::vector<Part>& parts, double duration) {
  std::vector<DriveSample> inputs;
  int most = 0;
  while (keyboard.time() < duration) {
    test::sample(parts, keyboard, inputs);
    int steps = 0;
    keyboard.tick(inputs, [&](int, const State&, const StepReport&, double) noexcept { ++steps; });
    most = std::max(most, steps);
  }
  return most;
}

TEST(Keyboard, TakesNoMoreStepsThanItsBudgetHoweverManyKeysArePlayed) {
  const Keystroke forte = test::keystroke("forte");
  const std::vector<Part> together(12, {&forte, 0, 0.7});  // all in phase: all would split the same steps
  Keyboard unbounded(test::grand_action().model, 12, settings_of(0));
  EXPECT_GT(most_steps(unbounded, together, 0.7), 60);
  for (const int budget : {60, 24, 12}) {
    Keyboard keyboard(test::grand_action().model, 12, settings_of(0), {}, budget);
    EXPECT_LE(most_steps(keyboard, together, 0.7), budget);
  }
}

TEST(Keyboard, WithinItsBudgetGivesTheSameBits) {
  const Keystroke forte = test::keystroke("forte");
  const std::vector<Part> parts{{&forte, 0, 0.7}, {&forte, 0.01, 0.7}};
  constexpr int kMost = 2 * 2 * (1 + 4);  // two keys, two steps each, every one of them tried and split in four
  Keyboard whole(test::grand_action().model, 2, settings_of(0));
  Keyboard bounded(test::grand_action().model, 2, settings_of(0), {}, kMost);
  std::vector<DriveSample> inputs;
  while (whole.time() < 0.7) {
    test::sample(parts, whole, inputs);
    whole.tick(inputs);
    bounded.tick(inputs);
    ASSERT_EQ(bounded.budget().level(), 0);
    for (std::size_t k = 0; k < 2; ++k) ASSERT_EQ(whole.forces()[k], bounded.forces()[k]) << whole.time();
  }
}

TEST(Keyboard, EventsOfEachKeyAreSeen) {
  const ActionFile action = test::grand_action();
  const Keystroke piano = test::keystroke("piano");
  Keyboard keyboard(action.model, 3, settings_of(0));
  std::vector<EventDetector> detector;
  for (int k = 0; k < 3; ++k) detector.emplace_back(keyboard.mechanism(k), action.roles);
  std::vector<DriveSample> inputs;
  while (keyboard.time() < 1.6) {
    test::sample({{}, {&piano, 0.1, 10}, {&piano, 0, 0.7}}, keyboard, inputs);
    keyboard.tick(inputs, [&](int k, const State& state, const StepReport&, double force) noexcept {
      detector[static_cast<std::size_t>(k)].observe(state, force);
    });
  }
  const auto impacts = [&](std::size_t k) {
    int count = 0;
    for (int i = 0; i < detector[k].count(); ++i) count += detector[k][i].kind == EventKind::hammer_meets_string;
    return count;
  };
  EXPECT_EQ(impacts(0), 0);
  EXPECT_EQ(impacts(1), 1);
  EXPECT_EQ(impacts(2), 3);
}

TEST(Keyboard, PlayAndSleepMakeNoHeapCall) {
  const Keystroke forte = test::keystroke("forte");
  Keyboard keyboard(test::grand_action().model, 4, settings_of(0));
  const std::vector<Part> parts{{}, {&forte, 0, 0.9}, {&forte, 0.3, 0.9}, {&forte, 0.1, 0.9, 0.1}};
  std::vector<DriveSample> inputs(4);
  KeyPool pool(keyboard, {KeyPool::kAnyCpu}, 0);
  long slept = 0;
  keyboard.tick(inputs);  // threads and sanitizers have their first calls behind them
  pool.tick(inputs);
  const long before = heap_calls;
  for (int i = 0; i < 4000; ++i) {
    test::sample(parts, keyboard, inputs);
    if (i % 2 == 0)
      keyboard.tick(inputs);
    else
      pool.tick(inputs);
    slept += keyboard.asleep_count();
  }
  EXPECT_EQ(heap_calls, before);
  EXPECT_GT(slept, 4000);
}

}  // namespace
}  // namespace erard
