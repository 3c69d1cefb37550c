// The benchmark harness: what its numbers mean. Nothing here asks how fast anything is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include "bench/distribution.hpp"
#include "bench/contender.hpp"
#include "bench/lanes.hpp"
#include "bench/least_work.hpp"
#include "bench/plan.hpp"
#include "bench/row.hpp"
#include "bench/sample_set.hpp"
#include "bench/targets.hpp"
#include "bench/thesis.hpp"
#include "erard/device/key_pool.hpp"
#include "erard/mechanics/rest.hpp"
#include "support/strokes.hpp"

namespace erard::bench {
namespace {

/// 1, 2, ... count in an order of no meaning.
std::vector<double> shuffled(int count) {
  std::vector<double> values(static_cast<std::size_t>(count));
  std::iota(values.begin(), values.end(), 1.0);
  std::shuffle(values.begin(), values.end(), std::mt19937(1));
  return values;
}

TEST(Distribution, OfTheFirstWholeNumbersIsKnown) {
  std::vector<double> values = shuffled(100000);
  const Distribution d = describe(values);
  EXPECT_EQ(d.count, 100000u);
  EXPECT_EQ(d.min, 1);
  EXPECT_EQ(d.median, 50000);
  EXPECT_EQ(d.p99, 99000);
  EXPECT_EQ(d.p999, 99900);
  EXPECT_EQ(d.p9999, 99990);
  EXPECT_EQ(d.max, 100000);
  EXPECT_EQ(d.total, 5000050000);
}

TEST(Distribution, QuantilesAreStatedOnlyWithTenValuesBeyond) {
  const auto stated = [](int count) {
    std::vector<double> values = shuffled(count);
    const Distribution d = describe(values);
    return std::vector<bool>{!std::isnan(d.p99), !std::isnan(d.p999), !std::isnan(d.p9999)};
  };
  using List = std::vector<bool>;
  EXPECT_EQ(stated(999), List({false, false, false}));
  EXPECT_EQ(stated(1000), List({true, false, false}));
  EXPECT_EQ(stated(9999), List({true, false, false}));
  EXPECT_EQ(stated(10000), List({true, true, false}));
  EXPECT_EQ(stated(99999), List({true, true, false}));
  EXPECT_EQ(stated(100000), List({true, true, true}));
}

TEST(Distribution, ItsTailIsNeverLessThanWhatItStandsFor) {
  std::vector<double> few = shuffled(500), many = shuffled(20000);
  EXPECT_EQ(describe(few).tail(), 500);  // p99.9 is not stated: the maximum
  EXPECT_EQ(describe(many).tail(), 19980);
}

TEST(Distribution, OfNothingSaysNothing) {
  const Distribution d = describe({});
  EXPECT_EQ(d.count, 0u);
  for (const double value : {d.min, d.median, d.p99, d.max, d.tail()}) EXPECT_TRUE(std::isnan(value));
}

TEST(Quantile, IsTheSmallestValueThatAShareOfAllDoesNotExceed) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> values(1 + random() % 300);
    for (double& value : values) value = static_cast<double>(random() % 50);  // with ties
    std::sort(values.begin(), values.end());
    for (const double q : {0.01, 0.25, 0.5, 0.9, 0.99, 1.0}) {
      const double found = quantile(values, q);
      const auto not_above = std::upper_bound(values.begin(), values.end(), found) - values.begin();
      const auto below = std::lower_bound(values.begin(), values.end(), found) - values.begin();
      const double wanted = q * static_cast<double>(values.size());
      EXPECT_GE(static_cast<double>(not_above), wanted - 1e-6) << "seed 7, trial " << trial << ", q " << q;
      EXPECT_LT(static_cast<double>(below), wanted) << "seed 7, trial " << trial << ", q " << q;
    }
  }
}

TEST(FastestOfPasses, IsThatOfEachTickAndNeedsFivePasses) {
  std::vector<double> times;
  for (int pass = 0; pass < 5; ++pass)
    for (int tick = 0; tick < 5; ++tick) times.push_back(tick == pass ? tick : 100 + tick);  // each undisturbed once
  EXPECT_EQ(fastest_of_passes(times, 5), std::vector<double>({0, 1, 2, 3, 4}));
  times.pop_back();
  EXPECT_TRUE(fastest_of_passes(times, 5).empty());
}

TEST(SampleSet, TakesTheClockOutOfEveryInterval) {
  SampleSet samples(2, 2);
  const std::int64_t ends[] = {1110, 1220};
  samples.add(1000, ends, 1250, 2000, 5010, 10);
  ASSERT_EQ(samples.ticks().size(), 1u);
  ASSERT_EQ(samples.steps().size(), 2u);
  EXPECT_NEAR(samples.ticks()[0], 220e-9, 1e-15);  // 250 ns with three looks at the clock
  EXPECT_NEAR(samples.steps()[0], 100e-9, 1e-15);
  EXPECT_NEAR(samples.steps()[1], 100e-9, 1e-15);
  EXPECT_NEAR(samples.noise()[0], 3000e-9, 1e-15);
  EXPECT_EQ(samples.room(), 1u);
}

TEST(SampleSet, ASliceThatWasBrokenOffIsForgotten) {
  SampleSet samples(10, 2);
  const std::int64_t ends[] = {10, 20};
  for (int i = 0; i < 7; ++i) samples.add(0, ends, 30, 40, 50, 0);
  samples.cut_back(4);
  EXPECT_EQ(samples.ticks().size(), 4u);
  EXPECT_EQ(samples.steps().size(), 8u);
  EXPECT_EQ(samples.noise().size(), 4u);
  EXPECT_EQ(samples.room(), 6u);
}

/// Forces of the first key over so many periods.
std::vector<double> play(Contender& contender, int periods) {
  std::vector<double> force;
  contender.start();
  for (int i = 0; i < periods; ++i) {
    contender.prepare();
    contender.tick({});
    force.push_back(contender.force());
  }
  return force;
}

Job keyboard_job(const char* scene, int keys) {
  const TickSettings settings;
  Job job{find_scene(scene), keys, 2000, settings.substeps, true};
  job.may_sleep = true;
  return job;
}

TEST(Erard, OfOneKeyPlaysWhatTheSimulationPlays) {
  ActionOptions options;
  options.damper = true;
  const Stage stage = load_stage(true);
  const test::Stroke stroke =
      test::play(test::grand_action(options), test::keystroke("forte"), test::default_tick(), 0.2);
  const std::vector<double> force = play(*make_erard(stage, keyboard_job("forte", 1)), 400);
  for (std::size_t i = 1; i < stroke.row.size(); ++i)
    ASSERT_EQ(force[i - 1], stroke.row[i].force) << "period " << i;  // the same calls, so the same bits
}

TEST(Erard, OfManyKeysPlaysTheSameEveryTimeAndOnAnyNumberOfThreads) {
  const Stage stage = load_stage(true);
  Job job = keyboard_job("keyboard_all", 3);
  const auto alone = make_erard(stage, job);
  job.worker_cpus = {KeyPool::kAnyCpu};
  const std::vector<double> force = play(*alone, 1200);  // a whole stroke of 0.6 s
  EXPECT_EQ(force, play(*alone, 1200));
  EXPECT_EQ(force, play(*make_erard(stage, job), 1200));
  EXPECT_GT(*std::max_element(force.begin(), force.end()), 5);  // [N] it is played, forte
}

TEST(Erard, PlaysTheSameInTheLanesOfEveryInstructionSet) {
  if (lane_names().empty()) GTEST_SKIP() << "this build has no lanes";
  const Stage stage = load_stage(true);
  Job job = keyboard_job("keyboard_all", 9);
  const std::vector<double> force = play(*make_erard(stage, job), 400);
  for (const std::string& name : lane_names()) {
    job.lanes = name;
    EXPECT_EQ(force, play(*make_erard(stage, job), 400)) << name;  // to the bit, erard/lanes/key_lanes.hpp
  }
}

TEST(Erard, LeavesKeysAloneThatNobodyPlaysAndOnlyWhereItMay) {
  const Stage stage = load_stage(true);
  Job job = keyboard_job("keyboard_some", 8);
  const auto sleeping = make_erard(stage, job);
  job.may_sleep = false;
  const auto awake = make_erard(stage, job);
  const std::vector<double> with = play(*sleeping, 400), without = play(*awake, 400);
  EXPECT_GE(sleeping->effort().asleep, 4);  // of 8 keys 4 are never played
  EXPECT_EQ(awake->effort().asleep, 0);
  for (std::size_t i = 0; i < with.size(); ++i)
    ASSERT_NEAR(with[i], without[i], 1e-9) << "period " << i;  // [N] docs/keyboard.md has 4e-10 at most
}

TEST(Erard, HasBegunEveryPartWhenTheClockStarts) {
  const Stage stage = load_stage(true);
  const std::vector<Part> parts = cast(*find_scene("keyboard_all"), stage, 88);
  for (const Part& part : parts) {
    EXPECT_EQ(part.at(0.999 * part.delay).value, 0);
    EXPECT_LT(part.delay, duration_of(*find_scene("keyboard_all"), stage));
    EXPECT_GT(part.at(part.delay + 0.06).value, 1e-4);  // [m] pressed: a keystroke of 100 to 200 ms begins at 0
  }
}

TEST(Keyboard, NoTwoOf88KeysAreInPhase) {
  std::set<double> phases;
  for (int key = 0; key < 88; ++key) phases.insert(phase_of(key));
  ASSERT_EQ(phases.size(), 88u);
  double before = *phases.rbegin() - 1;
  for (const double phase : phases) {
    EXPECT_GT(phase - before, 2 * 0.5 / 600);  // two periods of 2 kHz in a stroke of 600 ms
    before = phase;
  }
}

TEST(Scene, PlaysAsManyKeysAsItSays) {
  const Stage stage = load_stage(true);
  for (const int keys : {8, 44, 88})
    for (const Scene& scene : scenes()) {
      if (!scene.is_keyboard) continue;
      const std::vector<Part> parts = cast(scene, stage, keys);
      const auto played =
          std::count_if(parts.begin(), parts.end(), [](const Part& p) { return p.keystroke != nullptr; });
      EXPECT_EQ(parts.size(), static_cast<std::size_t>(keys));
      EXPECT_EQ(played, played_keys(scene.played, keys)) << scene.name << ", " << keys;
    }
  EXPECT_EQ(played_keys(Played::some, 88), 8);
  EXPECT_EQ(played_keys(Played::some, 8), 4);
}

TEST(Accuracy, OfAConstantOffsetIsThatOffset) {
  ForceCurve truth, curve;
  for (int i = 0; i <= 1000; ++i) {
    truth.time.push_back(1e-4 * i);
    truth.force.push_back(2);
  }
  for (int i = 0; i <= 200; ++i) {
    curve.time.push_back(5e-4 * i);
    curve.force.push_back(i <= 100 ? 2.5 : 100);  // what comes after the release does not count
  }
  const Error error = error_of(truth, curve, 0.05);
  EXPECT_NEAR(error.rms_N, 0.5, 1e-12);
  EXPECT_NEAR(error.eta, 0.25, 1e-12);
  EXPECT_TRUE(std::isnan(error_of({}, curve, 0.05).eta));
}

TEST(Plan, HasEverySettingOnce) {
  std::set<std::string> names;
  for (const Match& match : make_plan({})) {
    names.insert(match.scene->name);
    std::set<std::tuple<int, bool, FeltModel>> entrants;
    for (const Entrant& each : match.entrants)
      EXPECT_TRUE(entrants.insert({each.substeps, each.is_split, each.felts}).second);
  }
  EXPECT_EQ(names.size(), scenes().size());
}

TEST(Plan, SharesALargeKeyboardOutToTwoThreadsWhereThereAreCpus) {
  const auto shared = [](int cpus) {
    Request request;
    request.cpus = cpus;
    request.with_peers = true;
    std::vector<Match> found;
    for (const Match& match : make_plan(request))
      if (match.threads > 1) found.push_back(match);
    return found;
  };
  EXPECT_TRUE(shared(1).empty());
  ASSERT_EQ(shared(2).size(), 1u);
  const Match match = shared(2)[0];
  EXPECT_EQ(match.keys, 88);
  EXPECT_EQ(match.rate_Hz, 10000);
  ASSERT_EQ(match.entrants.size(), 1u);  // the peer has one thread
  EXPECT_EQ(match.entrants[0].setting, "cheapest");
}

TEST(Plan, RefusesMoreThreadsThanCpus) {
  Request request;
  request.threads = 3;
  request.cpus = 2;
  EXPECT_THROW(make_plan(request), InputError);
}

TEST(Plan, LetsNoKeySleepWhereThatIsSwitchedOff) {
  Request request;
  request.may_sleep = false;
  for (const Match& match : make_plan(request))
    for (const Entrant& each : match.entrants) EXPECT_FALSE(each.may_sleep) << match.scene->name;
}

/// A row as one of the plan, its times all the same.
Row row_of(const char* scene, int keys, double rate_Hz, double tick, double undisturbed) {
  Row row;
  row.scene = scene;
  row.keys = keys;
  row.rate_Hz = rate_Hz;
  row.setting = "cheapest";
  std::vector<double> ticks(20000, tick), fastest(20000, undisturbed);
  row.tick = describe(ticks);
  row.undisturbed = describe(fastest);
  return row;
}

TEST(Targets, AreJudgedByTheTimesAsMeasuredAndByTheWorstScene) {
  std::vector<Row> rows{row_of("piano", 1, 2000, 3e-6, 2e-6), row_of("forte", 1, 2000, 5e-6, 3e-6),
                        row_of("keyboard_none", 88, 2000, 88 * 0.2e-6, 88 * 0.2e-6)};
  std::map<std::string, Target> found;
  for (const Target& target : targets_of(rows)) found[target.claim] = target;
  const Target& p99 = found.at("one key, strokes: p99 of a step");
  EXPECT_NEAR(p99.measured, 5, 1e-9);
  EXPECT_NEAR(p99.undisturbed, 3, 1e-9);
  EXPECT_EQ(p99.where, "forte");
  EXPECT_EQ(verdict(p99), "missed (met undisturbed)");  // at most 4 us
  const Target& rest = found.at("a key at rest, one of 88: median");
  EXPECT_NEAR(rest.measured, 0.2, 1e-9);
  EXPECT_EQ(verdict(rest), "missed");
  EXPECT_EQ(verdict(found.at("88 keys all played, cheapest: median")), "not measured");
  rows[1].tick.p99 = 4e-6;
  for (const Target& target : targets_of(rows))
    if (target.claim == p99.claim) {
      EXPECT_EQ(verdict(target), "met");
    }
}

TEST(Thesis, TookTenMillisecondsAStep) {
  std::vector<Row> rows{row_of("piano", 1, 2000, 2e-6, 1e-6), row_of("piano", 1, 2000, 20e-6, 10e-6)};
  rows[1].felts = FeltModel::bodies;
  const std::vector<ThesisLine> lines = beside_thesis(rows);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_DOUBLE_EQ(lines[0].thesis, 0.010);      // 20 s for 2000 steps of 0.5 ms
  EXPECT_NEAR(lines[0].measured, 20e-6, 1e-12);  // felts as bodies first, as in the thesis
  EXPECT_NEAR(lines[1].undisturbed, 1e-6, 1e-12);
}

double of(const Work& work, Phase phase) { return work[static_cast<std::size_t>(phase)]; }

TEST(LeastWork, OfTheFactorisationIsWhatADenseEliminationTouchesThatKnowsTheZeros) {
  const Stage stage = load_stage(true);
  const Mechanism& mechanism = stage.mechanism();
  const int n = mechanism.coordinate_count;
  std::vector<std::vector<bool>> is_set(static_cast<std::size_t>(n), std::vector<bool>(static_cast<std::size_t>(n)));
  for (int k = 0; k < n; ++k)
    for (int a = 0; a < mechanism.elimination.count[k]; ++a)
      is_set[static_cast<std::size_t>(k)][static_cast<std::size_t>(mechanism.elimination.list[k][a])] = true;
  double count = 0;
  for (std::size_t k = is_set.size(); k-- > 0;) {
    count += 3;  // 1/D, its product with the load, the load itself
    for (std::size_t i = 0; i < k; ++i) {
      if (!is_set[k][i]) continue;
      count += 1 + 2 + 2;  // L, a load upwards, downwards
      for (std::size_t j = 0; j <= i; ++j) count += is_set[k][j] ? 2 : 0;
    }
  }
  EXPECT_EQ(of(least_work(mechanism, rest_state(mechanism, 5e-4)), Phase::factorisation), count);
}

TEST(LeastWork, HasOnePowerForEachFeltThatIsClosedAndNoOneStepProblem) {
  const Stage stage = load_stage(true);
  const Mechanism& mechanism = stage.mechanism();
  State state = rest_state(mechanism, 5e-4);
  state.impulse.setZero();
  state.compression.setZero();
  const Work open = least_work(mechanism, state);
  EXPECT_EQ(of(open, Phase::felt_laws), 0);
  EXPECT_EQ(of(open, Phase::rows) + of(open, Phase::sweeps), 0);
  state.impulse[mechanism.normal_row[0]] = 1;
  const Work closed = least_work(mechanism, state);
  EXPECT_GT(of(closed, Phase::felt_laws), 50);   // a power counts as many
  EXPECT_LT(of(closed, Phase::felt_laws), 100);  // one of them
  EXPECT_EQ(of(closed, Phase::gaps), of(open, Phase::gaps));
  EXPECT_GT(of(closed, Phase::linearisation), of(open, Phase::linearisation));
}

TEST(Row, ComparesWithThePeerAtTheSameNumberOfSteps) {
  std::vector<Row> rows(3);
  rows[1].engine = rows[2].engine = Engine::mujoco;
  rows[2].substeps = 4;
  rows[0].tick.median = 3, rows[1].tick.median = 2, rows[2].tick.median = 30;
  rows[0].undisturbed.total = 1, rows[1].undisturbed.total = 2, rows[2].undisturbed.total = 20;
  for (Row& row : rows) row.undisturbed.count = 1;
  compare_with_peers(rows);
  EXPECT_EQ(rows[0].times_peer_median, 1.5);
  EXPECT_EQ(rows[0].times_peer_undisturbed, 0.5);
  EXPECT_TRUE(std::isnan(rows[1].times_peer_median));
}

}  // namespace
}  // namespace erard::bench
