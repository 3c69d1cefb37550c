// erard-sim as its users meet it.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <chrono>
#include <sstream>
#include <thread>

#include "erard/erard.hpp"
#include "support/program.hpp"

namespace erard {
namespace {

using namespace test;

TEST(ErardSim, WithoutArgumentsPlaysTheDefaultStrikeAndTellsAPerson) {
  const auto outcome = run_program("erard-sim");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* word :
       {"peak", "escapement", "hammer meets string", "m/s", "faster than real time", "recorded_fast"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << outcome.out;
}

TEST(ErardSim, WritesTrajectoryEventsAndSummary) {
  const TemporaryFolder folder;
  const std::string out = folder / "run";
  ASSERT_EQ(run_program("erard-sim --keystroke " ERARD_CONFIG_DIR "/keystrokes/piano.csv --out " + out).exit_code, 0);
  std::istringstream trajectory(read_text(out + "/trajectory.csv"));
  std::string header, row;
  std::getline(trajectory, header);
  EXPECT_EQ(
      header,
      "t_s,input,y_m,force_N,theta_K,theta_W,theta_J,theta_L,theta_H,theta_D,omega_K,omega_W,omega_J,omega_L,omega_H,"
      "omega_D,delta_KS+_m,delta_KW_m,delta_KS-_m,delta_KH_m,delta_KD_m,delta_WJ_m,delta_WL_m,delta_JG_m,delta_JL_m,"
      "delta_JH_m,delta_LG_m,delta_LH_m,delta_HG_m,delta_DG_m,normal_KS+_N,normal_KW_N,normal_KS-_N,normal_KH_N,"
      "normal_KD_N,normal_WJ_N,normal_WL_N,normal_JG_N,normal_JL_N,normal_JH_N,normal_LG_N,normal_LH_N,normal_HG_N,"
      "normal_DG_N");
  int rows = 0;
  while (std::getline(trajectory, row)) {
    ++rows;
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), 43);
  }
  EXPECT_EQ(rows, 1200);  // 0.5995 s at 2 kHz and the start
  const YAML::Node events = YAML::LoadFile(out + "/events.yaml");
  ASSERT_GT(events.size(), 5u);
  for (const YAML::Node& event : events)
    for (const char* key : {"name", "time_s", "strike", "hammer_speed_m_per_s", "y_m", "force_N"})
      EXPECT_TRUE(event[key].IsDefined()) << key;
  const YAML::Node summary = YAML::LoadFile(out + "/summary.yaml");
  EXPECT_TRUE(summary["complete"].as<bool>());
  EXPECT_GT(summary["real_time_factor"].as<double>(), 0);
  const int fewest = 1199 * summary["substeps"].as<int>();
  EXPECT_GE(summary["steps"].as<int>(), fewest);
  EXPECT_LE(summary["steps"].as<int>(), fewest * summary["refinement"].as<int>());
  for (const auto& entry : std::filesystem::directory_iterator(out)) EXPECT_NE(entry.path().extension(), ".part");
}

TEST(ErardSim, TwoRunsGiveTheSameBytes) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"})
    ASSERT_EQ(run_program("erard-sim --out " + (folder / name).string() + " --dump-osnsp " + (folder / name).string() +
                          ".json")
                  .exit_code,
              0);
  for (const char* file : {"/trajectory.csv", "/events.yaml", ".json"}) {
    const std::string a = read_text((folder / "a").string() + file);
    EXPECT_FALSE(a.empty());
    EXPECT_EQ(a, read_text((folder / "b").string() + file)) << file;
  }
}

TEST(ErardSim, ComparesWithAForceCurve) {
  const auto outcome =
      run_program("erard-sim --keystroke " ERARD_CONFIG_DIR "/keystrokes/piano.csv --compare " ERARD_REFERENCE_DIR
                  "/piano.csv --compare-until 0.22");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("eta 0."), std::string::npos) << outcome.out;
}

TEST(ErardSim, AScrewTurnedChangesTheForceAndAWrongNameIsTold) {
  const auto peak = [](const std::string& options) {
    const TemporaryFolder folder;
    EXPECT_EQ(run_program("erard-sim --out " + folder.path().string() + options).exit_code, 0);
    return YAML::LoadFile(folder / "summary.yaml")["force_peak_N"].as<double>();
  };
  EXPECT_NE(peak(""), peak(" --set S_Jy=0.0590"));
  expect_one_sentence(run_program("erard-sim --set S_Jyy=0.059"), {"--set", "S_Jyy", "S_Jy"});
  expect_one_sentence(run_program("erard-sim --set S_Jy=nan"), {"--set", "S_Jy=nan"});
  expect_one_sentence(run_program("erard-sim --set S_Jy"), {"--set", "NAME=VALUE"});
  expect_one_sentence(run_program("erard-sim --set m_H=-1"), {"m_H", "-1", "> 0"});
  expect_one_sentence(run_program("erard-sim --without XY"), {"XY", "KS+"});
}

TEST(ErardSim, DrivesMustFitTheirFile) {
  const TemporaryFolder folder;
  write_text(folder / "force.csv", "t_s,force_N\n0,0\n0.05,1\n0.1,1\n");
  EXPECT_EQ(run_program("erard-sim --keystroke " + (folder / "force.csv").string()).exit_code, 0);
  expect_one_sentence(run_program("erard-sim --drive piston --keystroke " + (folder / "force.csv").string()),
                      {"force.csv", "force_N", "piston"});
  expect_one_sentence(run_program("erard-sim --drive force"), {"position_m", "force"});
  EXPECT_EQ(run_program("erard-sim --drive key").exit_code, 0);
}

TEST(ErardSim, OptionsOutOfRangeAreToldInOneSentence) {
  expect_one_sentence(run_program("erard-sim --rate 0"), {"--rate", "400 to 50000"});
  expect_one_sentence(run_program("erard-sim --rate nan"), {"--rate", "nan"});
  expect_one_sentence(run_program("erard-sim --rate fast"), {"--rate", "fast"});
  expect_one_sentence(run_program("erard-sim --substeps 0"), {"--substeps", "1 to 1000"});
  expect_one_sentence(run_program("erard-sim --duration -1"), {"--duration"});
  expect_one_sentence(run_program("erard-sim --duration inf"), {"--duration"});
  expect_one_sentence(run_program("erard-sim --damper maybe"), {"--damper", "maybe"});
  expect_one_sentence(run_program("erard-sim --frobnicate"), {"--frobnicate"});
  expect_one_sentence(run_program("erard-sim surplus"), {"surplus"});
}

TEST(ErardSim, PlacesThatCannotBeUsedAreToldInOneSentence) {
  const TemporaryFolder folder;
  write_text(folder / "file", "x");
  expect_one_sentence(run_program("erard-sim --out " + (folder / "file").string()), {"file"});
  expect_one_sentence(run_program("erard-sim --out /proc/no/such"), {"/proc/no/such"});
  expect_one_sentence(run_program("erard-sim --keystroke " + folder.path().string()), {folder.path().string()});
  expect_one_sentence(run_program("erard-sim --action " + folder.path().string()), {folder.path().string()});
  expect_one_sentence(run_program("erard-sim --keystroke /no/such/file.csv"), {"/no/such/file.csv"});
  expect_one_sentence(run_program("erard-sim --action /no/such/file.yaml"), {"/no/such/file.yaml"});
  expect_one_sentence(run_program("erard-sim --compare /no/such/file.csv"), {"/no/such/file.csv"});
  expect_one_sentence(run_program("erard-sim --dump-osnsp /no/such/place/p.json"), {"/no/such/place/p.json"});
  expect_one_sentence(run_program("erard-sim --dump-osnsp " + folder.path().string()),
                      {folder.path().string(), "is a folder"});
  std::filesystem::create_directories(folder / "run" / "summary.yaml");
  expect_one_sentence(run_program("erard-sim --out " + (folder / "run").string()), {"summary.yaml", "is a folder"});
  EXPECT_FALSE(std::filesystem::exists(folder / "run" / "trajectory.csv"));
}

TEST(ErardSim, DumpedProblemsAreThoseThatWereSolved) {
  const TemporaryFolder folder;
  const std::string dump = folder / "problems.json";
  ASSERT_EQ(
      run_program("erard-sim --substeps 4 --keystroke " ERARD_CONFIG_DIR "/keystrokes/forte.csv --dump-osnsp " + dump)
          .exit_code,
      0);
  std::istringstream lines(read_text(dump));
  std::string line;
  int count = 0;
  double worst = 0;
  for (; std::getline(lines, line); ++count) {
    if (count % 40 != 0) continue;
    const YAML::Node node = YAML::Load(line);  // JSON is YAML
    OneStepProblem problem;
    const int m = problem.size = static_cast<int>(node["q"].size());
    problem.W.resize(m, m);
    problem.q.resize(m);
    RowVector r(m);
    for (int i = 0; i < m; ++i) {
      problem.q[i] = node["q"][i].as<double>();
      r[i] = node["r"][i].as<double>();
      for (int j = 0; j < m; ++j) problem.W(i, j) = node["W"][i][j].as<double>();
      const YAML::Node cone = node["cone"][i];
      const std::string kind = cone["kind"].as<std::string>();
      if (kind == "half_line") problem.cone[i] = {ConeKind::half_line, -1, 0, false};
      if (kind == "friction")
        problem.cone[i] = {ConeKind::friction, cone["normal"].as<int>(), cone["mu"].as<double>(), false};
      if (kind == "interval")
        problem.cone[i] = {ConeKind::interval, -1, cone["bound"].as<double>(), cone["angular"].as<bool>()};
    }
    worst = std::max(worst, residual(problem, r));
  }
  EXPECT_EQ(count, 4796);    // 1199 periods of four steps
  EXPECT_LT(worst, 1.1e-6);  // the tolerance of the sweeps
}

TEST(ErardSim, NothingToCompareIsNoAgreement) {
  const TemporaryFolder folder;
  expect_one_sentence(run_program("erard-sim --compare " ERARD_REFERENCE_DIR "/piano.csv --compare-until -1"),
                      {"--compare", "must overlap"});
  write_text(folder / "late.csv", "t_s,force_N\n100,1\n101,1\n");
  expect_one_sentence(run_program("erard-sim --compare " + (folder / "late.csv").string()),
                      {"late.csv", "must overlap"});
  expect_one_sentence(run_program("erard-sim --compare-until 0.1"), {"--compare-until", "--compare"});
}

TEST(ErardSim, KeystrokesMustFitTheRun) {
  const TemporaryFolder folder;
  write_text(folder / "long.csv", "t_s,position_m\n0,0\n80000,0.001\n");
  expect_one_sentence(run_program("erard-sim --keystroke " + (folder / "long.csv").string()), {"long.csv", "3600 s"});
  EXPECT_EQ(run_program("erard-sim --duration 0.1 --keystroke " + (folder / "long.csv").string()).exit_code, 0);
  write_text(folder / "short.csv", "t_s,position_m\n0,0\n0.00001,0.000001\n");
  expect_one_sentence(run_program("erard-sim --keystroke " + (folder / "short.csv").string()),
                      {"short.csv", "duration"});
  write_text(folder / "jump.csv", "t_s,position_m\n0,0.01\n0.1,0.01\n");
  expect_one_sentence(run_program("erard-sim --drive key --keystroke " + (folder / "jump.csv").string()),
                      {"jump.csv", "rest"});
}

TEST(ErardSim, FilesOfOneRunMustNotBeTheSame) {
  const TemporaryFolder folder;
  const std::string out = folder / "run";
  expect_one_sentence(run_program("erard-sim --out " + out + " --dump-osnsp " + out + "/trajectory.csv"),
                      {"--dump-osnsp", "another file"});
  write_text(folder / "k.csv", "t_s,position_m\n0,0\n0.1,0.001\n");
  const std::string k = folder / "k.csv";
  expect_one_sentence(run_program("erard-sim --keystroke " + k + " --dump-osnsp " + k),
                      {"--dump-osnsp", "another file"});
}

TEST(ErardSim, MessagesStayOnOneLineWhateverTheyQuote) {
  expect_one_sentence(run_program("erard-sim --action \"$(printf 'a\\nb')\""), {"a"});
  expect_one_sentence(run_program("erard-sim --set \"$(printf 'a\\nb')\""), {"a"});
  expect_one_sentence(run_program("erard-sim --drive \"$(printf 'a\\nb')\""), {"a"});
  expect_one_sentence(run_program("erard-sim --set m_H=0x1"), {"m_H=0x1"});
}

TEST(ErardSim, ALostSummaryIsAFailure) { EXPECT_EQ(run_program("erard-sim --duration 0.1 >/dev/full").exit_code, 1); }

TEST(ErardSim, CoarseStepsAreTold) {
  EXPECT_NE(run_program("erard-sim --rate 400 --substeps 1").out.find("NOTE"), std::string::npos);
  EXPECT_EQ(run_program("erard-sim --rate 400").out.find("NOTE"), std::string::npos);
}

TEST(ErardSim, BadInputLeavesNoFiles) {
  const TemporaryFolder folder;
  run_program("erard-sim --keystroke /no/such/file.csv --out " + (folder / "run").string());
  run_program("erard-sim --set nothing=1 --out " + (folder / "run").string());
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}

TEST(ErardSim, InterruptKeepsWhatIsComplete) {
  const TemporaryFolder folder;
  const std::string out = folder / "run";
  // the program itself is in the foreground of its shell; timeout sends it what Ctrl-C sends
  const auto outcome = run_program("erard-sim --version >/dev/null; timeout -s INT 1 " ERARD_PROGRAM_DIR
                                   "/erard-sim --duration 3600 --out " +
                                   out + "; echo code $?");
  EXPECT_NE(outcome.out.find("INTERRUPTED"), std::string::npos) << outcome.out << outcome.error;
  const YAML::Node summary = YAML::LoadFile(out + "/summary.yaml");
  EXPECT_FALSE(summary["complete"].as<bool>());
  EXPECT_EQ(summary["stopped_by"].as<std::string>(), "interrupt");
  std::istringstream trajectory(read_text(out + "/trajectory.csv"));
  std::string header, row, last;
  std::getline(trajectory, header);
  int rows = 0;
  while (std::getline(trajectory, row)) ++rows, last = row;
  EXPECT_EQ(rows, summary["periods"].as<int>() + 1);
  EXPECT_EQ(std::count(last.begin(), last.end(), ','), 43);
  YAML::LoadFile(out + "/events.yaml");
}

TEST(ErardSim, HelpNamesUnitsDefaultsAndExitCodes) {
  const auto outcome = run_program("erard-sim --help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* word :
       {"--action", "--keystroke", "--drive", "--rate", "Hz", "--substeps", "--duration", "--without", "--set",
        "--damper", "--out", "--compare", "--dump-osnsp", "Exit codes", "2000"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  EXPECT_NE(run_program("erard-sim --version").out.find("erard-sim 0."), std::string::npos);
}

}  // namespace
}  // namespace erard
