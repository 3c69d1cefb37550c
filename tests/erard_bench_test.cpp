// erard-bench as its users meet it. Nothing here asks how fast it is.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "bench/contender.hpp"
#include "support/program.hpp"

namespace erard::bench {
namespace {

using test::expect_one_sentence;
using test::read_text;
using test::run_program;
using test::TemporaryFolder;

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
  for (const char* word : {"median", "p99.9", "Noise floor", "forte", "keyboard_all", "commit", "% of T"})
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
    // a keyboard that sleeps takes less than a look at the clock, which is subtracted
    if (row.at("scene") != "keyboard_none") {
      EXPECT_GT(number("tick_min_us"), 0);
    }
    EXPECT_EQ(number("keys_asleep"), row.at("scene") == "keyboard_none"   ? 8
                                     : row.at("scene") == "keyboard_some" ? 4
                                                                          : 0);
    EXPECT_GT(number("noise_min_us"), 1);  // 18000 operations, each after the other: nobody computes at 18 GHz
    if (number("keys") == 1) {
      EXPECT_GT(number("iterations_a_step"), 0.5);
    }
    EXPECT_NEAR(number("share_of_period"), number("tick_max_us") * 1e-6 * number("rate_Hz"),
                1e-4 * number("share_of_period"));
    if (row.at("eta") != "") eta[row.at("scene") + row.at("setting")] = number("eta");
  }
  EXPECT_EQ(eta.size(), 4u);
  EXPECT_LT(eta["piano"
                "default"],
            eta["piano"
                "cheapest"]);  // two to eight steps a period against one
  EXPECT_LT(eta["forte"
                "default"],
            eta["forte"
                "cheapest"]);
  EXPECT_LT(eta["forte"
                "default"],
            0.02);  // 0.3 % where the damper does not play along

  const YAML::Node json = YAML::LoadFile(json_file);  // JSON is YAML
  EXPECT_TRUE(json["complete"].as<bool>());
  EXPECT_EQ(json["circumstances"]["commit"].as<std::string>(), csv.comments.at("commit"));
  ASSERT_EQ(json["rows"].size(), csv.rows.size());
  EXPECT_EQ(json["targets"][1]["verdict"].as<std::string>().substr(0, 1), "m");  // met, or missed on a busy machine
  EXPECT_EQ(json["targets"][3]["verdict"].as<std::string>(), "not measured");    // 88 keys
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
  expect_one_sentence(run_program("erard-bench --threads 0"), {"--threads"});
  expect_one_sentence(run_program("erard-bench --lanes mmx"), {"--lanes", "mmx"});
  expect_one_sentence(run_program("erard-bench --lanes avx512 --threads 2"), {"--lanes avx512"});  // or has none
  expect_one_sentence(run_program("erard-bench --sleep maybe"), {"--sleep", "maybe"});
  expect_one_sentence(run_program("erard-bench --margin 0"), {"--margin"});
  expect_one_sentence(run_program("erard-bench --margin nan"), {"--margin"});
  expect_one_sentence(run_program("erard-bench --damper maybe"), {"--damper", "maybe"});
  expect_one_sentence(run_program("erard-bench --csv /no/such/place/b.csv"), {"/no/such/place/b.csv"});
  expect_one_sentence(run_program("erard-bench --csv x --json x"), {"--csv", "--json"});
  expect_one_sentence(run_program("erard-bench --json x --markdown x"), {"--json", "--markdown"});
  expect_one_sentence(run_program("erard-bench --frobnicate"), {"--frobnicate"});
}

TEST(ErardBench, TablesGoBetweenTheirLinesOfAPageAndNowhereElse) {
  const TemporaryFolder folder;
  const std::string page = folder / "page.md", fresh = folder / "fresh.md", other = folder / "other.md";
  const std::string begin = "<!-- erard-bench: written by the program, do not edit -->\n";
  const std::string end = "<!-- end of erard-bench -->\n";
  test::write_text(page, "before\n" + begin + "old\n" + end + "after\n");
  test::write_text(other, "no place\n");
  const std::string command = "erard-bench --quick --scene rest --setting cheapest --markdown ";
  ASSERT_EQ(run_program(command + page).exit_code, 0);
  const std::string text = read_text(page);
  EXPECT_TRUE(text.starts_with("before\n" + begin)) << text;
  EXPECT_TRUE(text.ends_with(end + "after\n")) << text;
  EXPECT_EQ(text.find("old"), std::string::npos) << text;
  EXPECT_NE(text.find("| rest | cheapest |"), std::string::npos) << text;
  ASSERT_EQ(run_program(command + fresh).exit_code, 0);
  EXPECT_TRUE(read_text(fresh).starts_with(begin));
  expect_one_sentence(run_program(command + other), {"other.md", "no place"});
  EXPECT_EQ(read_text(other), "no place\n");
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
  for (const char* word :
       {"--scene",    "--keys",        "--rate",    "Hz",     "--setting",  "--repeat",  "--quick", "--margin",
        "--realtime", "--peers",       "--csv",     "--json", "--markdown", "--threads", "--sleep", "on two threads",
        "Exit codes", "keyboard_some", "1,8,44,88", "20000"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  EXPECT_NE(run_program("erard-bench --version").out.find("erard-bench 0."), std::string::npos);
}

}  // namespace
}  // namespace erard::bench
