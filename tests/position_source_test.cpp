// Recorded positions: keystrokes and LCM logs as a row of messages.
#include "erard/device/position_source.hpp"

#include <gtest/gtest.h>

#include <random>

#include "erard/device/error.hpp"
#include "erard/device/link.hpp"
#include "support/program.hpp"
#include "support/udp.hpp"

namespace erard {
namespace {

using test::big_endian;
using test::encoded;
using test::read_text;
using test::TemporaryFolder;
using test::write_text;

std::string log_event(std::int64_t time_us, const std::string& channel, const std::string& payload) {
  return big_endian(0xEDA1DA01, 4) + big_endian(0, 8) + big_endian(static_cast<std::uint64_t>(time_us), 8) +
         big_endian(channel.size(), 4) + big_endian(payload.size(), 4) + channel + payload;
}

positions_t positions_of(std::int64_t publisher, std::int64_t device_time_ns) {
  positions_t positions{};
  positions.publisher_id = publisher;
  positions.device_time_ns = device_time_ns;
  positions.key_count = 1;
  return positions;
}

std::string complaint_of(const std::filesystem::path& file) {
  try {
    LogSource source(file, "P");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(KeystrokeSource, SamplesTheSplineAtItsRate) {
  const Keystroke keystroke(KeystrokeQuantity::position, {0.1, 0.15, 0.3, 0.4}, {0, 0.002, 0.009, 0.001});
  KeystrokeSource source(keystroke, 0.001, {.key_count = 5, .key = 2, .kind = positions_t::kKey});
  EXPECT_EQ(source.message_count(), 301);  // both ends
  EXPECT_EQ(source.duration_ns(), 300'000'000);
  positions_t positions;
  std::int64_t time = -1;
  for (int i = 0; i < 301; ++i) {
    ASSERT_TRUE(source.next(positions, time));
    EXPECT_EQ(time, i * 1'000'000);
    EXPECT_EQ(positions.key_count, 5);
    EXPECT_EQ(positions.kind, positions_t::kKey);
    for (int key = 0; key < 88; ++key)
      EXPECT_EQ(positions.position_m[key], key == 2 ? keystroke.at(keystroke.start() + i * 0.001).value : 0);
  }
  EXPECT_FALSE(source.next(positions, time));
  source.rewind();
  EXPECT_TRUE(source.next(positions, time));
  EXPECT_EQ(time, 0);
}

TEST(KeystrokeSource, PlaysOnAllKeysUnlessToldOtherwise) {
  KeystrokeSource source(Keystroke(KeystrokeQuantity::position, {0, 1}, {0.003, 0.004}), 0.5, {.key_count = 88});
  positions_t positions;
  std::int64_t time = 0;
  ASSERT_TRUE(source.next(positions, time));
  for (const double position : positions.position_m) EXPECT_EQ(position, 0.003);
}

TEST(LogSource, KeepsThePaceOfTheDevice) {
  const TemporaryFolder folder;
  // the logger's clock stumbles, the device's does not
  write_text(folder / "log", log_event(5000, "P", encoded(positions_of(3, 1'000'000))) +
                                 log_event(4000, "P", encoded(positions_of(3, 1'500'000))) +
                                 log_event(9000, "Q", encoded(positions_of(3, 1'700'000))) +
                                 log_event(9000, "P", encoded(forces_t{})) +
                                 log_event(9999, "P", encoded(positions_of(3, 2'000'001))));
  LogSource source(folder / "log", "P");
  EXPECT_EQ(source.message_count(), 3);
  EXPECT_EQ(source.duration_ns(), 1'000'001);
  positions_t positions;
  std::int64_t time = -1;
  for (const std::int64_t expected : {0, 500'000, 1'000'001}) {
    ASSERT_TRUE(source.next(positions, time));
    EXPECT_EQ(time, expected);
  }
  EXPECT_FALSE(source.next(positions, time));
}

TEST(LogSource, TakesTheLoggersClockWhereTheDevicesSaysNothing) {
  const TemporaryFolder folder;
  constexpr std::int64_t kSecond = 1'000'000'000;
  write_text(folder / "log", log_event(1'000'000, "P", encoded(positions_of(3, 50 * kSecond))) +
                                 log_event(1'000'500, "P", encoded(positions_of(4, 7))) +  // another publisher: 500 us
                                 log_event(1'000'800, "P", encoded(positions_of(4, 3))) +  // falls: 300 us
                                 log_event(1'000'900, "P", encoded(positions_of(4, 30 * kSecond))) +  // leaps: 100 us
                                 log_event(900'000, "P", encoded(positions_of(4, 0))) +               // both fall: 0
                                 log_event(9'000'000'000, "P", encoded(positions_of(5, 0))) +         // silence: 10 s
                                 log_event(-5, "P", encoded(positions_of(5, INT64_MIN))) +            // nonsense: 0
                                 log_event(INT64_MAX, "P", encoded(positions_of(5, INT64_MAX))));     // 10 s
  LogSource source(folder / "log", "P");
  positions_t positions;
  std::int64_t time = -1;
  for (const std::int64_t expected :
       {0L, 500'000L, 800'000L, 900'000L, 900'000L, 10'000'900'000L, 10'000'900'000L, 20'000'900'000L}) {
    ASSERT_TRUE(source.next(positions, time));
    EXPECT_EQ(time, expected);
  }
}

TEST(LogSource, LeavesOutAnEventThatTheFileEndsWithin) {
  const TemporaryFolder folder;
  const std::string one = log_event(1, "P", encoded(positions_of(3, 1)));
  for (const std::size_t size : {std::size_t{1}, std::size_t{27}, std::size_t{28}, one.size() - 1}) {
    write_text(folder / "log", one + one + one.substr(0, size));
    LogSource source(folder / "log", "P");
    EXPECT_EQ(source.message_count(), 2);
    EXPECT_TRUE(source.is_cut_short());
  }
}

TEST(LogSource, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string file = folder / "log";
  const std::string one = log_event(1, "P", encoded(positions_of(3, 1)));
  EXPECT_EQ(complaint_of(file), file + ": cannot be read (No such file or directory), must be an LCM log");
  EXPECT_EQ(complaint_of(folder.path()),
            folder.path().string() + ": cannot be read (it is a folder), must be an LCM log");
  write_text(file, one + "garbage, and more of it than a header has" + one);
  EXPECT_EQ(complaint_of(file), file + ": event 1 at byte " + std::to_string(one.size()) +
                                    " is damaged: it does not begin with the bytes ED A1 DA 01; the 1 events before it "
                                    "can be read");
  write_text(file, log_event(1, "Q", encoded(positions_of(3, 1))) + log_event(1, "R", encoded(forces_t{})));
  EXPECT_EQ(complaint_of(file), file + ": holds no erard.positions_t on channel P, but on Q");
}

TEST(LogSource, NeitherDiesNorHangsOnADamagedFile) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const TemporaryFolder folder;
  std::string whole;
  for (int i = 0; i < 4; ++i) whole += log_event(i, "P", encoded(positions_of(3, i)));
  for (int round = 0; round < 300; ++round) {
    std::string damaged = whole.substr(0, random() % (whole.size() + 1));
    for (int flips = 0; flips < 3 && !damaged.empty(); ++flips)
      damaged[random() % damaged.size() % 60] = static_cast<char>(random());
    write_text(folder / "log", damaged);
    complaint_of(folder / "log");
  }
}

}  // namespace
}  // namespace erard
