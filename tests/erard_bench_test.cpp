// The benchmark harness: what its numbers mean, and erard-bench as its users meet it. Nothing here asks how fast it is.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <sstream>

#include "bench/distribution.hpp"
#include "bench/keyboard.hpp"
#include "bench/plan.hpp"
#include "bench/row.hpp"
#include "bench/sample_set.hpp"
#include "support/program.hpp"
#include "support/strokes.hpp"

namespace erard::bench {
namespace {

using test::expect_one_sentence;
using test::read_text;
using test::run_program;
using test::TemporaryFolder;

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

TEST(Keyboard, OfOneKeyPlaysWhatRunPlays) {
  ActionOptions options;
  options.damper = true;
  const Stage stage = load_stage(true);
  const Keystroke keystroke = test::keystroke("forte");
  const test::Stroke stroke = test::play(test::grand_action(options), keystroke, test::default_tick(), 0.2);
  Keyboard keyboard(stage.mechanism, test::default_tick(), cast(*find_scene("forte"), stage, 1));
  keyboard.start();
  for (std::size_t i = 1; i < stroke.row.size(); ++i) {
    keyboard.tick({});
    ASSERT_EQ(keyboard.force(), stroke.row[i].force) << "period " << i;  // the same calls, so the same bits
  }
}

TEST(Keyboard, PlaysTheSameEveryTime) {
  const Stage stage = load_stage(true);
  Keyboard keyboard(stage.mechanism, test::default_tick(), cast(*find_scene("keyboard_all"), stage, 3));
  std::vector<double> force[2];
  for (auto& each : force) {
    keyboard.start();
    for (int i = 0; i < 1200; ++i) {  // a whole stroke of 0.6 s
      keyboard.tick({});
      each.push_back(keyboard.force());
    }
  }
  EXPECT_EQ(force[0], force[1]);
  EXPECT_GT(*std::max_element(force[0].begin(), force[0].end()), 5);  // [N] it is played, forte
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
  EXPECT_EQ(played_keys(Played::some, 88), 10);
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

TEST(Plan, HasEverySettingOnceAndKeyboardsAtTwoKilohertz) {
  std::set<std::string> names;
  for (const Match& match : make_plan({})) {
    names.insert(match.scene->name);
    std::set<int> substeps;
    for (const Entrant& entrant : match.entrants) EXPECT_TRUE(substeps.insert(entrant.substeps).second);
    if (match.scene->is_keyboard) {
      EXPECT_EQ(match.rate_Hz, 2000);
    }
  }
  EXPECT_EQ(names.size(), scenes().size());
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

// ---- the program

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line)
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  return cells;
}

struct Csv {
  std::map<std::string, std::string> comments;
  std::vector<std::map<std::string, std::string>> rows;
};

/// Fails the test when a row has not as many cells as the header.
Csv read_csv(const std::string& file) {
  Csv csv;
  std::istringstream lines(read_text(file));
  std::vector<std::string> header;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# ")) {
      const std::size_t colon = line.find(": ");
      csv.comments[line.substr(2, colon - 2)] = line.substr(colon + 2);
      continue;
    }
    const std::vector<std::string> cells = split(line);
    if (header.empty()) {
      header = cells;
      continue;
    }
    EXPECT_EQ(cells.size(), header.size()) << line;
    auto& row = csv.rows.emplace_back();
    for (std::size_t i = 0; i < std::min(cells.size(), header.size()); ++i) row[header[i]] = cells[i];
  }
  return csv;
}

TEST(ErardBench, QuickRunWritesWholeFiles) {
  const TemporaryFolder folder;
  const std::string csv_file = folder / "b.csv", json_file = folder / "b.json";
  const auto outcome = run_program("erard-bench --quick --csv " + csv_file + " --json " + json_file);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* word : {"median", "p99.9", "noise floor", "forte", "keyboard_all", "commit", "% of T"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << outcome.out;

  const Csv csv = read_csv(csv_file);
  for (const char* key : {"commit", "compiler", "cpu", "kernel", "scheduling", "clock_overhead_us", "peer"})
    EXPECT_TRUE(csv.comments.contains(key)) << key;
  EXPECT_EQ(csv.comments.at("complete"), "true");
  EXPECT_EQ(csv.rows.size(), 12u);  // rest, piano, forte, three keyboards, two settings each
  std::map<std::string, double> eta;
  for (const auto& row : csv.rows) {
    const auto number = [&](const std::string& name) { return std::stod(row.at(name)); };
    for (const char* what : {"tick", "noise"}) {
      const std::string name(what);
      EXPECT_LE(number(name + "_min_us"), number(name + "_median_us"));
      EXPECT_LE(number(name + "_median_us"), number(name + "_max_us"));
      EXPECT_EQ(row.at(name + "_p9999_us"), "");  // too few ticks
    }
    EXPECT_GT(number("tick_min_us"), 0);
    EXPECT_GT(number("noise_min_us"), 1);  // 18000 operations, each after the other: nobody computes at 18 GHz
    EXPECT_GT(number("iterations_a_step"), 0.5);
    EXPECT_NEAR(number("share_of_period"), number("tick_max_us") * 1e-6 * number("rate_Hz"),
                1e-4 * number("share_of_period"));
    if (row.at("eta") != "") eta[row.at("scene") + row.at("setting")] = number("eta");
  }
  EXPECT_EQ(eta.size(), 4u);
  EXPECT_LT(eta["piano"
                "default"],
            eta["piano"
                "cheapest"]);  // four steps a period against one
  EXPECT_LT(eta["forte"
                "default"],
            eta["forte"
                "cheapest"]);
  EXPECT_LT(eta["forte"
                "default"],
            0.02);  // docs/performance.md: 0.6 %

  const YAML::Node json = YAML::LoadFile(json_file);  // JSON is YAML
  EXPECT_TRUE(json["complete"].as<bool>());
  EXPECT_EQ(json["circumstances"]["commit"].as<std::string>(), csv.comments.at("commit"));
  ASSERT_EQ(json["rows"].size(), csv.rows.size());
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    EXPECT_EQ(json["rows"][i].size(), csv.rows[i].size());
    EXPECT_EQ(json["rows"][i]["scene"].as<std::string>(), csv.rows[i].at("scene"));
    EXPECT_NEAR(json["rows"][i]["tick_median_us"].as<double>(), std::stod(csv.rows[i].at("tick_median_us")),
                1e-5 * std::stod(csv.rows[i].at("tick_median_us")));
    EXPECT_TRUE(json["rows"][i]["tick_p9999_us"].IsNull());
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".part");
}

TEST(ErardBench, AMarginThatNobodyKeepsIsMissedAndOneThatAllKeepIsNot) {
  const std::string command = "erard-bench --quick --scene rest --setting cheapest --margin ";
  const auto missed = run_program(command + "1e-9");
  EXPECT_EQ(missed.exit_code, 1) << missed.error;
  EXPECT_NE(missed.out.find("MISSED: rest with 1 key at 2000 Hz"), std::string::npos) << missed.out;
  const auto kept = run_program(command + "1e9");
  EXPECT_EQ(kept.exit_code, 0) << kept.error;
  EXPECT_EQ(kept.out.find("MISSED"), std::string::npos) << kept.out;
}

TEST(ErardBench, WrongArgumentsAreToldInOneSentence) {
  expect_one_sentence(run_program("erard-bench --scene waltz"), {"--scene", "waltz", "recorded_fast"});
  expect_one_sentence(run_program("erard-bench --scene forte --keys 88"), {"--keys"});
  expect_one_sentence(run_program("erard-bench --keys 0"), {"--keys"});
  expect_one_sentence(run_program("erard-bench --rate 399"), {"--rate", "400 to 50000"});
  expect_one_sentence(run_program("erard-bench --rate nan"), {"--rate", "nan"});
  expect_one_sentence(run_program("erard-bench --setting best"), {"--setting", "best"});
  expect_one_sentence(run_program("erard-bench --repeat 0"), {"--repeat"});
  expect_one_sentence(run_program("erard-bench --margin 0"), {"--margin"});
  expect_one_sentence(run_program("erard-bench --margin nan"), {"--margin"});
  expect_one_sentence(run_program("erard-bench --damper maybe"), {"--damper", "maybe"});
  expect_one_sentence(run_program("erard-bench --csv /no/such/place/b.csv"), {"/no/such/place/b.csv"});
  expect_one_sentence(run_program("erard-bench --csv x --json x"), {"--csv", "--json"});
  expect_one_sentence(run_program("erard-bench --frobnicate"), {"--frobnicate"});
}

TEST(ErardBench, InterruptKeepsWhatWasMeasured) {
  const TemporaryFolder folder;
  const std::string file = folder / "b.csv";
  const auto outcome =
      run_program("erard-bench --version >/dev/null; timeout --preserve-status -s INT 3 " ERARD_PROGRAM_DIR
                  "/erard-bench --scene rest --rate 2000 --setting cheapest --repeat 100 --csv " +
                  file);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.error;
  EXPECT_NE(outcome.out.find("INTERRUPTED"), std::string::npos) << outcome.out;
  const Csv csv = read_csv(file);
  EXPECT_EQ(csv.comments.at("complete"), "false");
  ASSERT_EQ(csv.rows.size(), 1u);
  EXPECT_EQ(std::stol(csv.rows[0].at("ticks")) % 1200, 0);  // whole slices of 0.6 s
}

TEST(ErardBench, RealTimeIsGrantedOrRefusedNeverQuietlyLeftOut) {
  const auto outcome = run_program("erard-bench --quick --scene rest --setting cheapest --realtime");
  if (outcome.exit_code == 0) {
    EXPECT_NE(outcome.out.find("SCHED_FIFO, memory locked"), std::string::npos) << outcome.out;
  } else {
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.error.find("--realtime: "), std::string::npos) << outcome.error;
    EXPECT_NE(outcome.error.find("ulimit"), std::string::npos) << outcome.error;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(ErardBench, ThePeerPlaysTooOrIsSaidToBeMissing) {
  const TemporaryFolder folder;
  const std::string file = folder / "b.csv";
  const auto outcome = run_program("erard-bench --quick --scene forte --setting default --peers --csv " + file);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Csv csv = read_csv(file);
  if (mujoco_version().empty()) {
    EXPECT_NE(outcome.out.find("MuJoCo is not installed"), std::string::npos) << outcome.out;
    EXPECT_EQ(csv.rows.size(), 1u);
    return;
  }
  ASSERT_EQ(csv.rows.size(), 2u);
  EXPECT_EQ(csv.rows[1].at("engine"), "mujoco");
  EXPECT_GT(std::stod(csv.rows[0].at("times_peer_median")), 0);
  // it converges to its own fine run, as a stroke that is played and no explosion does: 2.7 % where this was written
  EXPECT_LT(std::stod(csv.rows[1].at("eta")), 0.1);
}

TEST(ErardBench, ALostTableIsAFailure) {
  EXPECT_EQ(run_program("erard-bench --quick --scene rest --setting cheapest >/dev/full").exit_code, 1);
}

TEST(ErardBench, HelpNamesUnitsDefaultsScenesAndExitCodes) {
  const auto outcome = run_program("erard-bench --help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* word : {"--scene", "--keys", "--rate", "Hz", "--setting", "--repeat", "--quick", "--margin",
                           "--realtime", "--peers", "--csv", "--json", "Exit codes", "keyboard_some", "1,8,44,88"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  EXPECT_NE(run_program("erard-bench --version").out.find("erard-bench 0."), std::string::npos);
}

}  // namespace
}  // namespace erard::bench
