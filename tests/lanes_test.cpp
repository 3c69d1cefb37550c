// Keys in the lanes of vector registers: the bits of the scalar engine, on every scene, with every instruction set.
#include <gtest/gtest.h>

#include <limits>

#include "erard/lanes/key_lanes.hpp"
#include "support/heap_calls.hpp"
#include "support/device.hpp"
#include "support/scenes.hpp"

namespace erard {
namespace {

using test::Part;

SleepSettings no_sleep() {
  SleepSettings sleep;
  sleep.is_on = false;
  return sleep;
}

TickSettings settings_of(int internal_steps, DriveKind drive = DriveKind::piston) {
  TickSettings settings;
  settings.drive = drive;
  settings.set_rate(2000, internal_steps);
  return settings;
}

std::vector<InstructionSet> available_sets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : kInstructionSets)
    if (is_available(set)) sets.push_back(set);
  return sets;
}

class EverySet : public testing::TestWithParam<InstructionSet> {};
INSTANTIATE_TEST_SUITE_P(Lanes, EverySet, testing::ValuesIn(available_sets()),
                         [](const auto& set) { return std::string(name_of(set.param)); });

/// What lanes and the scalar engine made of a scene.
struct Comparison {
  double worst = 0;     // difference of the finger force of any key [N]
  long other_bits = 0;  // forces, periods times keys
  long other_reports = 0;
  bool is_same_end = true;  // every number of every state
  LanePlayer::Count count;
};

bool is_same(const State& a, const State& b) {
  return a.x == b.x && a.v == b.v && a.acceleration == b.acceleration && a.compression == b.compression &&
         a.impulse == b.impulse && a.time == b.time && a.time_step == b.time_step;
}

bool is_same(const StepReport& a, const StepReport& b) {
  return a.status == b.status && a.linearisations == b.linearisations && a.sweeps == b.sweeps &&
         a.newton_change == b.newton_change && a.surprise == b.surprise && a.sweep_error == b.sweep_error &&
         a.finger_force == b.finger_force;
}

Comparison compare(const std::vector<Model>& models, const std::vector<int>& model_of_key,
                   const std::vector<Part>& parts, double duration, const TickSettings& settings, InstructionSet set,
                   const SleepSettings& sleep = no_sleep(), int most_steps = StepBudget::kUnbounded) {
  Keyboard scalar(models, model_of_key, settings, sleep, most_steps),
      keyboard(models, model_of_key, settings, sleep, most_steps);
  KeyLanes lanes(keyboard, set);
  Comparison result;
  std::vector<DriveSample> inputs;
  std::vector<StepReport> reports(parts.size()), others(parts.size());
  const auto into = [](std::vector<StepReport>& list) {
    return [&list](int key, const State&, const StepReport& report, double) noexcept { list[key] = report; };
  };
  while (scalar.time() < duration) {
    test::sample(parts, scalar, inputs);
    const auto truth = scalar.tick(inputs, into(reports)), forces = lanes.tick(inputs, into(others));
    for (std::size_t k = 0; k < parts.size(); ++k) {
      // negated: a force that is not a number is the worst
      if (!(std::abs(forces[k] - truth[k]) <= result.worst)) result.worst = std::abs(forces[k] - truth[k]);
      result.other_bits += forces[k] != truth[k];
      result.other_reports += !is_same(reports[k], others[k]);
    }
  }
  for (int k = 0; k < scalar.size(); ++k)
    result.is_same_end = result.is_same_end && is_same(scalar.state(k), keyboard.state(k)) &&
                         scalar.is_asleep(k) == keyboard.is_asleep(k);
  result.count = lanes.count();
  return result;
}

/// The bits are the same where both engines call one C library whose powers and sines are rounded well, and where both are
/// compiled for the same dot products and without contraction: on x86-64 with glibc, by this project's own flags. Elsewhere
/// they agree to rounding, which decisions of the solver may enlarge.
void expect_same(const Comparison& result, const std::string& what) {
  EXPECT_EQ(result.worst, 0) << what;
  EXPECT_EQ(result.other_bits, 0) << what;
  EXPECT_EQ(result.other_reports, 0) << what;
  EXPECT_TRUE(result.is_same_end) << what;
  EXPECT_GT(result.count.in_lanes, 50 * result.count.one_by_one) << what;
}

/// Five keys, an odd number for every instruction set, each at another place of its stroke; one is not touched.
std::vector<Part> spread(const Keystroke& keystroke, double every) {
  std::vector<Part> parts(5);
  for (std::size_t k = 0; k < 4; ++k) parts[k] = {&keystroke, 0.037 * double(k), every};
  return parts;
}

TEST_P(EverySet, GivesTheBitsOfTheScalarEngineOnEveryKeystroke) {
  const std::vector<Model> models{test::grand_action().model};
  for (const char* name : {"piano", "forte", "repetition", "recorded_fast"}) {
    const Keystroke keystroke = test::keystroke(name);
    for (const int steps : {1, 0})
      expect_same(compare(models, std::vector<int>(5, 0), spread(keystroke, 0.7), 0.9, settings_of(steps), GetParam()),
                  name + std::string(steps == 0 ? ", default" : ", cheapest"));
  }
}

TEST_P(EverySet, GivesTheBitsOfTheScalarEngineWithADamper) {
  ActionOptions options;
  options.damper = true;
  const Keystroke forte = test::keystroke("forte");
  expect_same(compare({test::grand_action(options).model}, std::vector<int>(5, 0), spread(forte, 0.7), 0.5,
                      settings_of(1), GetParam()),
              "damper");
}

TEST_P(EverySet, LetsKeysSleepAndWakeAsTheScalarEngineDoes) {
  const Keystroke piano = test::keystroke("piano");
  const std::vector<Part> parts{{&piano, 0.1, 1.2}, {}, {&piano, 0.3, 1.2, 0.15}, {&piano, 0.2, 0.9}};
  for (const SleepSettings& sleep : {SleepSettings{}, SleepSettings::eager()}) {
    const Comparison result =
        compare({test::grand_action().model}, std::vector<int>(4, 0), parts, 1.5, settings_of(1), GetParam(), sleep);
    expect_same(result, "sleep");
    EXPECT_LT(result.count.in_lanes, 3 * 3000);  // of 4 x 3000: they did sleep
  }
}

TEST_P(EverySet, RendersTheForcesOfTheScalarEngine) {
  RenderSettings settings;
  settings.keys = 5;
  const ActionFile action = test::grand_action();
  test::Device scalar(action, settings), laned(action, settings);
  KeyLanes lanes(laned.renderer.keyboard(), GetParam());
  laned.renderer.play_by(&lanes);
  const Keystroke forte = test::keystroke("forte");
  const std::vector<Part> parts = spread(forte, 0.7);
  std::vector<double> positions(5);
  std::size_t blows = 0;
  for (int i = 0; i < 1600; ++i) {
    for (std::size_t k = 0; k < 5; ++k) positions[k] = parts[k].at(5e-4 * i - 0.1).value;
    const PeriodOutput &truth = scalar.send(positions), &out = laned.send(positions);
    for (std::size_t k = 0; k < 5; ++k) ASSERT_EQ(truth.key[k].force, out.key[k].force) << i;
    ASSERT_EQ(truth.blow.size(), out.blow.size());
    blows += out.blow.size();
  }
  EXPECT_GE(blows, 4u);
  EXPECT_GT(lanes.count().in_lanes, 1000);
}

TEST_P(EverySet, GivesUpOnASlowStepAsTheScalarEngineDoes) {
  const Keystroke fast = test::keystroke("recorded_fast");
  TickSettings settings = settings_of(1);
  for (const int limit : {2, 3}) {  // linearisations; the default is reached once in 10000 steps
    settings.scheme.newton_limit = limit;
    expect_same(
        compare({test::grand_action().model}, std::vector<int>(5, 0), spread(fast, 0.7), 0.9, settings, GetParam()),
        "limit");
  }
}

TEST_P(EverySet, KeepsToTheStepBudgetAsTheScalarEngineDoes) {
  const Keystroke forte = test::keystroke("forte");
  // with 5 keys awake no step is split, with one all may be
  expect_same(compare({test::grand_action().model}, std::vector<int>(5, 0), spread(forte, 0.7), 0.9, settings_of(0),
                      GetParam(), SleepSettings::eager(), 10),
              "budget");
}

TEST_P(EverySet, StepsGradedKeysTogether) {
  std::vector<Model> models;
  for (const double mass : {0.009, 0.0095, 0.0105, 0.0125}) {
    ActionOptions options;
    options.settings = {{"m_H", mass}, {"k_HG", mass * 1.5e12}};
    models.push_back(test::grand_action(options).model);
  }
  const Keystroke forte = test::keystroke("forte");
  for (const int steps : {1, 0}) {
    const Comparison result = compare(models, {0, 1, 3, 2, 1}, spread(forte, 0.6), 0.8, settings_of(steps), GetParam());
    expect_same(result, "graded");
    // together: batches are as many as for equal keys
    const Comparison equal =
        compare({models[0]}, {0, 0, 0, 0, 0}, spread(forte, 0.6), 0.8, settings_of(steps), GetParam());
    EXPECT_LT(double(result.count.batches), 1.1 * double(equal.count.batches));
  }
}

TEST_P(EverySet, KeepsMechanismsOfOtherStructureApart) {
  ActionOptions without;
  without.without = {"KH"};
  const Keystroke forte = test::keystroke("forte");
  expect_same(compare({test::grand_action().model, test::grand_action(without).model}, {0, 1, 0, 1, 1},
                      spread(forte, 0.6), 0.5, settings_of(1), GetParam()),
              "structures");
}

TEST_P(EverySet, PlaysAnyNumberOfKeys) {
  const std::vector<Model> models{test::grand_action().model};
  const Keystroke forte = test::keystroke("forte");
  for (int keys = 1; keys <= 17; keys += keys < 9 ? 1 : 8) {
    std::vector<Part> parts;
    for (int k = 0; k < keys; ++k) parts.push_back({&forte, 0.003 * k, 1});
    expect_same(compare(models, std::vector<int>(parts.size(), 0), parts, 0.12, settings_of(1), GetParam()),
                std::to_string(keys) + " keys");
  }
}

TEST_P(EverySet, FollowsEveryDrive) {
  const std::vector<Model> models{test::grand_action().model};
  std::vector<double> times, values;
  for (double t = 0; t < 0.4; t += 1e-3) {
    times.push_back(t);
    values.push_back(1 - std::cos(20 * t));
  }
  const Keystroke push{KeystrokeQuantity::force, times, values};
  expect_same(
      compare(models, std::vector<int>(5, 0), spread(push, 0.4), 0.4, settings_of(0, DriveKind::force), GetParam()),
      "force");
  expect_same(
      compare(models, std::vector<int>(5, 0), std::vector<Part>(5), 0.1, settings_of(0, DriveKind::none), GetParam()),
      "none");
  for (double& value : values) value *= 0.004;
  const Keystroke motion{KeystrokeQuantity::position, times, values};
  const Comparison alone =
      compare(models, std::vector<int>(5, 0), spread(motion, 0.4), 0.2, settings_of(0, DriveKind::key), GetParam());
  EXPECT_EQ(alone.worst, 0);
  EXPECT_EQ(alone.count.in_lanes, 0);  // the reaction of a prescribed key is not computed in lanes
}

TEST_P(EverySet, StepsWhatItCannotOneByOne) {
  ActionOptions bodies;
  bodies.felts = FeltModel::bodies;
  const Keystroke piano = test::keystroke("piano");
  const Comparison result = compare({test::grand_action().model, test::grand_action(bodies).model}, {0, 1, 0},
                                    {{&piano}, {&piano, 0.01}, {&piano, 0.02}}, 0.1, settings_of(1), GetParam());
  EXPECT_EQ(result.worst, 0);
  EXPECT_TRUE(result.is_same_end);
  EXPECT_EQ(result.count.in_lanes, 2 * 200);
  EXPECT_EQ(result.count.one_by_one, 200);
}

TEST_P(EverySet, InputThatIsNotFiniteConcernsItsOwnKeyAlone) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  const Keystroke forte = test::keystroke("forte");
  for (const int steps : {1, 0})
    for (const double bad : {kNan, kInfinity}) {
      Keyboard scalar(test::grand_action().model, 5, settings_of(steps)),
          keyboard(test::grand_action().model, 5, settings_of(steps));
      KeyLanes lanes(keyboard, GetParam());
      std::vector<DriveSample> inputs;
      for (int i = 0; i < 400; ++i) {
        test::sample(spread(forte, 1), scalar, inputs);
        if (i % 50 == 7) inputs[static_cast<std::size_t>(i / 50 % 5)].value = bad;
        if (i % 50 == 21) inputs[static_cast<std::size_t>(i / 50 % 5)].rate = bad;
        scalar.tick(inputs);
        lanes.tick(inputs);
        for (int k = 0; k < 5; ++k) {
          const auto key = static_cast<std::size_t>(k);
          ASSERT_EQ(scalar.forces()[key], keyboard.forces()[key]) << i << ", key " << k;
          ASSERT_EQ(scalar.statuses()[key], keyboard.statuses()[key]) << i << ", key " << k;
          ASSERT_TRUE(is_same(scalar.state(k), keyboard.state(k))) << i << ", key " << k;
        }
      }
    }
}

TEST_P(EverySet, AbsurdInputIsLeftToTheScalarEngine) {
  Keyboard scalar(test::grand_action().model, 3, settings_of(1)),
      keyboard(test::grand_action().model, 3, settings_of(1));
  KeyLanes lanes(keyboard, GetParam());
  const std::vector<DriveSample> inputs{{0, 0}, {0.05, 100}, {1e9, 1e12}};
  for (int i = 0; i < 20; ++i) {
    scalar.tick(inputs);
    lanes.tick(inputs);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(scalar.statuses()[k], keyboard.statuses()[k]) << i;
      ASSERT_EQ(scalar.forces()[k], keyboard.forces()[k]) << i;
    }
  }
  EXPECT_GT(lanes.count().one_by_one, 0);
}

TEST_P(EverySet, PlaysWithoutAHeapCall) {
  const Keystroke forte = test::keystroke("forte");
  Keyboard keyboard(test::grand_action().model, 5, settings_of(0));
  KeyLanes lanes(keyboard, GetParam());
  std::vector<DriveSample> inputs(5);
  lanes.tick(inputs);  // sanitizers have their first calls behind them
  const std::vector<Part> parts = spread(forte, 0.9);
  const long start = heap_calls;
  for (int i = 0; i < 2000; ++i) {
    test::sample(parts, keyboard, inputs);
    lanes.tick(inputs);
  }
  EXPECT_EQ(heap_calls, start);
  static_assert(noexcept(lanes.tick(inputs)));
}

TEST_P(EverySet, HasAsManyLanesAsItSays) {
  const Keystroke forte = test::keystroke("forte");
  const std::vector<Part> parts(16, Part{&forte});
  const Comparison result =
      compare({test::grand_action().model}, std::vector<int>(16, 0), parts, 0.05, settings_of(1), GetParam());
  EXPECT_EQ(result.count.in_lanes, 16 * 100);
  EXPECT_EQ(result.count.batches * lanes_of(GetParam()), 16 * 100);
}

TEST(Lanes, TheBestInstructionSetIsAvailable) { EXPECT_TRUE(is_available(best_instruction_set())); }

}  // namespace
}  // namespace erard
