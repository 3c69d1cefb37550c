// erard-device as its users meet it: arguments, recordings, the end.
#include <cstring>

#include "support/host_test.hpp"

namespace erard {
namespace {

using test::Child;
using test::eventually;
using test::expect_one_sentence;
using test::Outcome;
using test::read_text;
using test::run_program;
using test::TemporaryFolder;
using test::write_text;

TEST(ErardDevice, RefusesBadArgumentsInOneSentence) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& arguments, const std::vector<std::string>& pieces) {
    SCOPED_TRACE(arguments);
    expect_one_sentence(run_program("erard-device --best-effort " + arguments), pieces);
  };
  refused("--keys 0", {"--keys = 0", "1 to 88"});
  refused("--keys 89", {"--keys = 89", "1 to 88"});
  refused("--keys many", {"--keys", "many"});
  refused("--keys", {"--keys"});
  refused("--rate 399", {"--rate = 399", "400 to 50000 Hz"});
  refused("--rate 50001", {"--rate = 50001", "400 to 50000 Hz"});
  refused("--rate nan", {"--rate = nan", "400 to 50000 Hz"});
  refused("--drive hammer", {"--drive", "hammer", "piston", "key"});
  refused("--actuator hydraulic", {"--actuator hydraulic", "voice-coil, mr or none"});
  refused("--damper perhaps", {"--damper", "perhaps", "on", "off"});
  refused("--pace fast", {"--pace", "fast", "clock", "messages"});
  for (const std::string duration : {"0", "-1", "nan", "inf", "1e300"})
    refused("--duration " + duration, {"--duration = ", "above 0 and at most 1000000 s"});
  refused("--record /nowhere/session.lcm", {"/nowhere/session.lcm", "No such file or directory"});
  refused("--record ''", {"--record", "name a file"});
  refused("--faults /dev/null/faults", {"/dev/null/faults", "Not a directory"});
  refused("--device /nowhere.yaml", {"/nowhere.yaml", "No such file or directory"});
  refused("--action /nowhere.yaml", {"/nowhere.yaml", "No such file or directory"});
  refused("--bogus", {"--bogus", "--help"});
  refused("forte.csv", {"forte.csv", "--help"});
}

TEST(ErardDevice, RefusesAnActuatorOfTheDeviceFileThatItDoesNotKnow) {
  const TemporaryFolder folder;
  const std::string file = folder / "device.yaml";
  std::string text = read_text(ERARD_CONFIG_DIR "/device.yaml");
  const std::size_t place = text.find("kind: voice_coil");
  ASSERT_NE(place, std::string::npos);
  text.replace(place, std::strlen("kind: voice_coil"), "kind: hydraulic");
  write_text(file, text);
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n');
  expect_one_sentence(run_program("erard-device --best-effort --device " + file),
                      {file + ":" + std::to_string(line), "hydraulic", "voice_coil", "mr_brake"});
}

TEST(ErardDevice, HelpNamesEveryOptionAndHowItEnds) {
  const Outcome outcome = run_program("erard-device --help");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.error.empty());
  for (const char* const word : {"--device", "--action", "--keys", "--rate", "--drive", "--actuator", "--damper",
                                 "--pace", "--best-effort", "--record", "--faults", "--duration", "Exit codes"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
}

TEST(ErardDevice, EndsAfterTheDurationWithAReport) {
  if (const std::string refused = test::enter_own_network(); !refused.empty()) GTEST_SKIP() << refused;
  const Outcome outcome = run_program("erard-device --best-effort --faults '' --duration 0.3");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("\nfaults "), std::string::npos) << outcome.out;
}

TEST(ErardDevice, SaysWhenItsReportCannotBeWritten) {
  if (const std::string refused = test::enter_own_network(); !refused.empty()) GTEST_SKIP() << refused;
  Child host("erard-device", {"--best-effort", "--duration", "0.1"}, {.out = "/dev/full"});
  const Outcome outcome = host.wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.error.find("report could not be written"), std::string::npos) << outcome.error;
}

/// Strokes, recorded.
class ErardDeviceSession : public test::HostTest {
 protected:
  void play(const char* pace = "clock") {
    start({"--pace", pace});
    press();
    release_and_play_again();
    stop();
  }
  Outcome verify() const { return run_program("erard-replay --verify " + log().string()); }

  /// The recording with one bit changed. @param bit  of the byte, 0 is the lowest
  void flip(std::size_t byte, int bit) const {
    std::string bytes = read_text(log());
    bytes.at(byte) = static_cast<char>(bytes.at(byte) ^ (1 << bit));
    write_text(log(), bytes);
  }
  /// Where a message stands in the recording.
  template <typename Message>
  std::size_t place_of(const Message& message) const {
    const std::size_t place = read_text(log()).find(test::encoded(message));
    EXPECT_NE(place, std::string::npos);
    return place;
  }
};

class ErardDeviceAtEitherPace : public ErardDeviceSession, public testing::WithParamInterface<const char*> {};

INSTANTIATE_TEST_SUITE_P(Pace, ErardDeviceAtEitherPace, testing::Values("clock", "messages"),
                         [](const auto& suite) { return std::string(suite.param); });

TEST_P(ErardDeviceAtEitherPace, ARecordingGivesTheSameBitsAgain) {
  play(GetParam());
  const Outcome outcome = verify();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("the same forces, bit for bit"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("cut short"), std::string::npos) << outcome.out;
  EXPECT_GT(test::read_session(log()).periods.size(), 1000u);
}

TEST_F(ErardDeviceSession, ABitThatWasFlippedIsFound) {
  constexpr std::size_t kForce = 64, kPosition = 37;  // [B] in forces_t and positions_t, of key 0
  play();
  const std::string good = read_text(log());
  const test::RecordedSession session = test::read_session(log());
  const auto period = std::find_if(session.periods.begin(), session.periods.end(), [](const test::RecordedPeriod& one) {
    return one.force() > 3 && one.arrived.size() == 1;  // in the stroke
  });
  ASSERT_NE(period, session.periods.end());
  flip(place_of(period->forces) + kForce + 7, 0);  // the last bit of a force
  Outcome outcome = verify();
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_NE(outcome.out.find("differs      in 1 periods"), std::string::npos) << outcome.out;

  write_text(log(), good);
  flip(place_of(period->arrived[0]) + kPosition + 4, 0);  // 1e-9 of a position
  outcome = verify();
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_NE(outcome.out.find("other forces"), std::string::npos) << outcome.out;

  write_text(log(), good);
  flip(place_of(period->forces), 3);  // the type
  expect_one_sentence(verify(), {log().string(), "forces_t"});
}

TEST_P(ErardDeviceAtEitherPace, ADeviceThatSendsTwiceAsFastDoesNotHastenTheSimulation) {
  start({"--pace", GetParam()});
  device_->fall_silent();
  const Child replay("erard-replay", {ERARD_CONFIG_DIR "/keystrokes/forte.csv", "--rate", "4000", "--loop"});
  ASSERT_TRUE(eventually([&] { return device_->status().positions_accepted > 1000; }));
  const host_status_t before = device_->status();
  ASSERT_TRUE(eventually([&] { return device_->status().device_time_ns > before.device_time_ns + 1'000'000'000; }));
  const host_status_t after = device_->status();
  const double seconds = 1e-9 * static_cast<double>(after.device_time_ns - before.device_time_ns);
  // the clock may be led by 1 us a period; a machine that stalls makes it fewer
  EXPECT_LT(static_cast<double>(after.periods - before.periods), 1.02 * 2000 * seconds);
  EXPECT_GT(after.positions_accepted, before.positions_accepted + 500);
  stop();
}

TEST_F(ErardDeviceSession, PlaysWhatLcmsOwnLoggerHeardAndItsPlayerSendsAgain) {
  if (std::system("command -v lcm-logger > /dev/null && command -v lcm-logplayer > /dev/null") != 0)
    GTEST_SKIP() << "LCM's tools are not installed (liblcm-bin)";
  start();
  device_->fall_silent();
  const std::string file = folder_ / "heard.lcm", url = " --lcm-url='udpm://239.255.76.67:7667?ttl=0' ";
  std::thread logger(
      [&] { std::system(("timeout --signal=INT 3 lcm-logger" + url + file + " > " + file + ".out 2>&1").c_str()); });
  ASSERT_TRUE(eventually([&] { return test::fs::exists(file); }));
  Child replay("erard-replay", {ERARD_CONFIG_DIR "/keystrokes/forte.csv"});
  EXPECT_EQ(replay.wait().exit_code, 0);
  logger.join();
  ASSERT_TRUE(eventually([&] { return device_->heard().blows.size() == 1; }));
  const std::int64_t before = device_->status().positions_accepted;
  // its messages are as old as the log: the host goes by what they say of one another
  ASSERT_EQ(std::system(("lcm-logplayer" + url + file + " > /dev/null 2>&1").c_str()), 0);
  ASSERT_TRUE(eventually([&] { return device_->heard().blows.size() == 2; }));
  EXPECT_TRUE(eventually([&] { return device_->status().positions_accepted > 2 * before - 50; }));
  const std::vector<hammer_event_t> blows = device_->heard().blows;
  // the player keeps the pace by sleeping: some 0.1 ms of jitter in a press of 20 ms, and it averages
  EXPECT_NEAR(blows[1].speed_m_per_s, blows[0].speed_m_per_s, 0.03 * blows[0].speed_m_per_s);
  stop();
}

TEST_F(ErardDeviceSession, CtrlCLeavesTheWholeReportAndACompleteFileHoweverOftenItComes) {
  start();
  press();
  for (int i = 0; i < 5; ++i) {  // the force is there: it takes a while until it has faded
    host_->send(i % 2 == 0 ? SIGINT : SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  const Outcome outcome = host_->wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* const line : {"\nperiods ", "\nmissed ", "\nwake-up ", "\nwork ", "\nsample to force ",
                                 "\npage faults ", "\npositions ", "\nblows ", "\nforce ", "\nrecorded ", "\nfaults "})
    EXPECT_NE(outcome.out.find(line), std::string::npos) << line << outcome.out;
  const test::RecordedSession session = test::read_session(log());
  test::expect_safe(session);
  EXPECT_EQ(session.periods.back().force(), 0);  // and only then it went
  const Outcome verified = verify();
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  EXPECT_EQ(verified.out.find("cut short"), std::string::npos) << verified.out;
  ASSERT_TRUE(eventually([&] { return device_->status().state == host_status_t::kStopping; }));
}

}  // namespace
}  // namespace erard
