// erard-replay as its users meet it, in a network of the test's own.
#include <gtest/gtest.h>

#include <future>

#include "erard/device/keystroke.hpp"
#include "erard/device/link.hpp"
#include "support/own_network.hpp"
#include "support/program.hpp"
#include "support/udp.hpp"

namespace erard {
namespace {

using test::enter_own_network;
using test::eventually;
using test::expect_one_sentence;
using test::run_program;
using test::TemporaryFolder;
using test::write_text;

#define REQUIRE_OWN_NETWORK() \
  if (const std::string refused = enter_own_network(); !refused.empty()) GTEST_SKIP() << refused

using PositionReceiver = Receiver<positions_t>;

/// All messages that arrived; fewer than the receiver has room for, so that nobody has to hurry.
std::vector<positions_t> take_all(PositionReceiver& receiver, std::int64_t count) {
  EXPECT_LE(count, PositionReceiver::kRoom);
  EXPECT_TRUE(eventually([&] { return receiver.counts().accepted >= count; }));
  std::vector<positions_t> all;
  for (positions_t one; receiver.take(one);) all.push_back(one);
  return all;
}

const std::string kKeystroke = ERARD_CONFIG_DIR "/keystrokes/piano.csv";

TEST(ErardReplay, PublishesAKeystrokeStampedAnew) {
  REQUIRE_OWN_NETWORK();
  PositionReceiver receiver(kDeviceUrl, kPositionsChannel, ListenerSettings{0});
  const Keystroke keystroke = read_keystroke(kKeystroke);
  const double interval = 10.0 / 250;  // [s] of the keystroke a message
  const auto count = static_cast<std::int64_t>((keystroke.end() - keystroke.start()) / interval + 1e-9) + 1;
  const std::int64_t before = monotonic_time_ns();
  const auto outcome = run_program("erard-replay " + kKeystroke + " --rate 250 --speed 10 --keys 88 --key 39");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  const std::vector<positions_t> all = take_all(receiver, count);
  ASSERT_EQ(static_cast<std::int64_t>(all.size()), count);
  EXPECT_GT(count, 10);
  EXPECT_NE(outcome.out.find(std::to_string(count) + " messages of 88 keys"), std::string::npos) << outcome.out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].publisher_id, all[0].publisher_id);
    EXPECT_GT(all[i].publisher_id, 0);
    EXPECT_EQ(all[i].sequence, static_cast<std::int64_t>(i) + 1);
    EXPECT_GE(all[i].device_time_ns, before + static_cast<std::int64_t>(i) * 4'000'000);  // never before its instant
    EXPECT_EQ(all[i].key_count, 88);
    EXPECT_EQ(all[i].kind, positions_t::kPiston);
    EXPECT_EQ(all[i].position_m[38], 0);
    EXPECT_EQ(all[i].position_m[39], keystroke.at(keystroke.start() + double(i) * interval).value);
  }
  EXPECT_LE(all.back().device_time_ns, monotonic_time_ns());
}

TEST(ErardReplay, TwoRunsAreTwoPublishers) {
  REQUIRE_OWN_NETWORK();
  PositionReceiver receiver(kDeviceUrl, kPositionsChannel, ListenerSettings{0});
  const TemporaryFolder folder;
  write_text(folder / "short.csv", "t_s,position_m\n0,0\n0.01,0.001\n");
  const std::string command = "erard-replay --rate 100 " + (folder / "short.csv").string();
  for (int run = 0; run < 2; ++run) ASSERT_EQ(run_program(command).exit_code, 0);
  const std::vector<positions_t> all = take_all(receiver, 4);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].publisher_id, all[1].publisher_id);
  EXPECT_NE(all[1].publisher_id, all[2].publisher_id);
}

TEST(ErardReplay, GivesALogAgainWithItsPositions) {
  REQUIRE_OWN_NETWORK();
  const TemporaryFolder folder;
  const std::string log = folder / "session.lcm";
  ASSERT_EQ(run_program("erard-replay " + kKeystroke + " --rate 400 --speed 20 --keys 3 --url 'file://" + log +
                        "?mode=w' --channel OLD")
                .exit_code,
            0);
  PositionReceiver receiver(kDeviceUrl, "NEW", ListenerSettings{0});
  const auto outcome = run_program("erard-replay " + log + " --log-channel OLD --channel NEW --speed 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  const Keystroke keystroke = read_keystroke(kKeystroke);
  const auto count = static_cast<std::int64_t>((keystroke.end() - keystroke.start()) / 0.05 + 1e-9) + 1;
  const std::vector<positions_t> all = take_all(receiver, count);
  ASSERT_EQ(static_cast<std::int64_t>(all.size()), count);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].sequence, static_cast<std::int64_t>(i) + 1);
    EXPECT_EQ(all[i].key_count, 3);
    EXPECT_EQ(all[i].position_m[2], keystroke.at(keystroke.start() + double(i) * 0.05).value);
  }
}

TEST(ErardReplay, LoopsUntilInterruptedAndEndsCleanly) {
  REQUIRE_OWN_NETWORK();
  PositionReceiver receiver(kDeviceUrl, kPositionsChannel, ListenerSettings{0});
  const TemporaryFolder folder;
  write_text(folder / "short.csv", "t_s,position_m\n0,0\n0.02,0.001\n");
  // the shell's process becomes the program: its number is written before
  const std::string number = folder / "number";
  auto outcome = std::async(std::launch::async, [&] {
    return run_program("erard-replay --version >/dev/null && echo $$ > " + number +
                       " && exec " ERARD_PROGRAM_DIR "/erard-replay --loop --rate 100 " +
                       (folder / "short.csv").string());
  });
  ASSERT_TRUE(eventually([&] { return receiver.counts().accepted >= 7; }));  // 3 a round
  kill(std::stoi(test::read_text(number)), SIGINT);
  EXPECT_EQ(outcome.get().exit_code, 130);
  const std::vector<positions_t> all = take_all(receiver, 7);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].sequence, static_cast<std::int64_t>(i) + 1);
  EXPECT_EQ(all[3].position_m[0], 0);
  EXPECT_EQ(all[5].position_m[0], 0.001);
}

TEST(ErardReplay, RefusesInOneSentence) {
  const TemporaryFolder folder;
  const std::string force = folder / "force.csv", still = folder / "still.lcm";
  write_text(force, "t_s,force_N\n0,0\n1,2\n");
  { Sender("file://" + still + "?mode=w").publish(kPositionsChannel, positions_t{}); }
  expect_one_sentence(run_program("erard-replay"), {"erard-replay", "FILE", "--help"});
  expect_one_sentence(run_program("erard-replay /nowhere.csv"), {"/nowhere.csv", "No such file"});
  expect_one_sentence(run_program("erard-replay " + force), {force, "force_N", "must hold position_m"});
  expect_one_sentence(run_program("erard-replay --speed 0 " + kKeystroke), {"--speed = 0", "0.01 to 100"});
  expect_one_sentence(run_program("erard-replay --rate nan " + kKeystroke), {"--rate = nan", "1 to 50000"});
  expect_one_sentence(run_program("erard-replay --keys 89 " + kKeystroke), {"--keys = 89", "1 to 88"});
  expect_one_sentence(run_program("erard-replay --keys 5 --key 5 " + kKeystroke), {"--key = 5", "0 to 4"});
  expect_one_sentence(run_program("erard-replay --url tcpq://x " + kKeystroke), {"tcpq://x"});
  expect_one_sentence(run_program("erard-replay --channel '' " + kKeystroke), {"channel", "63"});
  expect_one_sentence(run_program("erard-replay --log-channel P " + kKeystroke), {"--log-channel", "no LCM log"});
  expect_one_sentence(run_program("erard-replay --rate 100 " + still), {still, "LCM log", "leave them out"});
  expect_one_sentence(run_program("erard-replay --channel X " + still), {still, "channel X", kPositionsChannel});
  expect_one_sentence(run_program("erard-replay --loop " + still), {still, "one instant", "--loop"});
}

}  // namespace
}  // namespace erard
