// What is recorded is what was pushed, whatever the disk and the other threads do. Also run under the thread sanitizer.
#include "erard/device/recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <iterator>
#include <thread>

#include "erard/device/error.hpp"
#include "support/program.hpp"
#include "support/records.hpp"

namespace erard {
namespace {

namespace fs = std::filesystem;
using test::FileSizeLimit;
using test::number_in;
using test::read_log;
using test::Record;
using test::record_of;
using test::TemporaryFolder;
using test::text_in;

TEST(EventRing, TellsWhatIsThereNotYetAndNoLonger) {
  EventRing ring(3, 16);  // 4
  EXPECT_EQ(ring.capacity(), 4u);
  RingEvent event;
  EXPECT_EQ(ring.read(0, event), EventRing::Found::not_yet);
  const std::byte data[] = {std::byte{1}, std::byte{2}, std::byte{3}};
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(ring.push(i, -i, std::span(data).first(static_cast<std::size_t>(i % 4))));
  EXPECT_EQ(ring.written(), 6u);
  EXPECT_EQ(ring.oldest(), 2u);
  EXPECT_EQ(ring.read(1, event), EventRing::Found::overwritten);
  EXPECT_EQ(ring.read(6, event), EventRing::Found::not_yet);
  for (int i = 2; i < 6; ++i) {
    ASSERT_EQ(ring.read(static_cast<std::uint64_t>(i), event), EventRing::Found::whole);
    EXPECT_EQ(event.channel, i);
    EXPECT_EQ(event.time_ns, -i);
    EXPECT_TRUE(std::equal(event.data.begin(), event.data.end(), data, data + i % 4));
  }
}

TEST(EventRing, LeavesOutWhatIsTooLarge) {
  EventRing ring(4, 16);
  const std::vector<std::byte> data(17);
  EXPECT_FALSE(ring.push(0, 0, data));
  EXPECT_TRUE(ring.push(0, 0, std::span(data).first(16)));
  EXPECT_EQ(ring.written(), 1u);
}

TEST(EventRing, ReadersSeeWholeEventsWhileTheyAreOverwritten) {
  // one slot, and events long enough to be met half-written
  constexpr std::size_t kWords = 256;
  EventRing ring(1, kWords * sizeof(std::uint64_t));
  const auto push = [&](std::uint64_t number) {
    std::uint64_t words[kWords];
    std::fill(std::begin(words), std::end(words), number);
    ring.push(0, static_cast<std::int64_t>(number), std::as_bytes(std::span(words)));
  };
  push(0);
  std::atomic<bool> is_over{false};
  std::thread reader([&] {
    RingEvent event;
    for (int whole = 0; whole < 20'000 && !testing::Test::HasFailure();) {
      const std::uint64_t number = ring.oldest();
      if (ring.read(number, event) != EventRing::Found::whole) continue;
      std::uint64_t words[kWords];
      EXPECT_EQ(event.data.size(), sizeof words);
      std::memcpy(words, event.data.data(), sizeof words);
      EXPECT_EQ(std::count(std::begin(words), std::end(words), number), static_cast<long>(kWords));
      EXPECT_EQ(event.time_ns, static_cast<std::int64_t>(number));
      ++whole;
    }
    is_over = true;
  });
  for (std::uint64_t number = 1; !is_over; ++number) {
    push(number);
    if (number % 16 == 0) std::this_thread::yield();  // or the reader would hardly find one
  }
  reader.join();
}

RecorderSettings session_in(const TemporaryFolder& folder) {
  return {.channels = {"IN", "OUT"}, .session_file = folder / "session", .session = "rate_Hz: 2000\n"};
}

TEST(Recorder, WritesEveryEventBetweenTheSessionAndItsEnd) {
  const TemporaryFolder folder;
  Recorder recorder(session_in(folder));
  EXPECT_TRUE(recorder.status().is_recording);
  std::thread real_time([&] {
    for (int i = 0; i < 10'000; ++i) recorder.push_record(i % 2, 1'000'000LL * i, record_of(i));
  });
  real_time.join();
  recorder.finish();
  const RecorderStatus status = recorder.status();
  EXPECT_FALSE(status.is_recording);
  EXPECT_EQ(status.trouble, "");
  EXPECT_EQ(status.lost, 0);
  EXPECT_EQ(status.events, 10'002);
  EXPECT_EQ(status.bytes, static_cast<std::int64_t>(fs::file_size(folder / "session")));
  const std::vector<LogEvent> events = read_log(folder / "session");
  ASSERT_EQ(events.size(), 10'002u);
  EXPECT_EQ(session_text(events.front(), folder / "session"), "rate_Hz: 2000\n");
  EXPECT_EQ(events.back().channel, Recorder::kEnd);
  EXPECT_EQ(text_in(events.back()), "lost: 0\n");
  for (int i = 0; i < 10'000; ++i) {
    const LogEvent& event = events[static_cast<std::size_t>(i) + 1];
    ASSERT_EQ(event.channel, i % 2 == 0 ? "IN" : "OUT");
    ASSERT_EQ(event.time_us, 1000 * i);
    ASSERT_EQ(number_in(event.data), i);
  }
}

TEST(Recorder, CountsAndMarksWhatItLost) {
  // a memory of 8 events, 1000 pushed at once: what the writer finds later is the rest
  const TemporaryFolder folder;
  RecorderSettings settings = session_in(folder);
  settings.history_events = 4;
  Recorder recorder(settings);
  for (int i = 0; i < 1000; ++i) recorder.push_record(0, 0, record_of(i));
  recorder.finish();
  const std::int64_t lost = recorder.status().lost;
  EXPECT_GT(lost, 0);
  std::int64_t expected = 0, marked = 0;
  for (const LogEvent& event : read_log(folder / "session")) {
    if (event.channel == "IN") {
      EXPECT_EQ(number_in(event.data), expected);
      ++expected;
    }
    if (event.channel != Recorder::kLost) continue;
    const std::int64_t gap = std::stoll(text_in(event).substr(6));
    expected += gap;
    marked += gap;
  }
  EXPECT_EQ(expected, 1000);
  EXPECT_EQ(marked, lost);
}

TEST(Recorder, CountsEventsThatItCannotTake) {
  const TemporaryFolder folder;
  RecorderSettings settings = session_in(folder);
  settings.largest_event = sizeof(Record) - 1;
  Recorder recorder(settings);
  recorder.push_record(0, 0, record_of(0));  // too large
  recorder.push_record(-1, 0, 'x');
  recorder.push_record(2, 0, 'x');
  recorder.push_record(1, 0, 'x');
  recorder.finish();
  EXPECT_EQ(recorder.status().refused, 3);
  EXPECT_EQ(recorder.status().events, 3);
}

TEST(Recorder, StopsOnAFullDiskAndKeepsWhatIsWhole) {
  const TemporaryFolder folder;
  Recorder recorder(session_in(folder));
  {
    const FileSizeLimit full(100'000);
    for (int i = 0; i < 10'000; ++i) recorder.push_record(0, 0, record_of(i));
    recorder.finish();
  }
  const RecorderStatus status = recorder.status();
  EXPECT_FALSE(status.is_recording);
  EXPECT_NE(status.trouble.find("session: recording stopped after"), std::string::npos) << status.trouble;
  EventLogReader reader(folder / "session");
  std::int64_t next = 0;
  for (reader.next(); const auto event = reader.next(); ++next) ASSERT_EQ(number_in(event->data), next);
  EXPECT_FALSE(reader.is_truncated());
  EXPECT_EQ(reader.events(), status.events);
  EXPECT_GT(next, 900);  // 99 bytes each
  EXPECT_LT(next, 1011);
}

TEST(Recorder, SavesTheNewestEventsOnAFault) {
  const TemporaryFolder folder;
  RecorderSettings settings{.channels = {"IN"}, .history_events = 100, .events_after_fault = 30};
  settings.fault_folder = folder / "faults";
  settings.session = "text";
  Recorder recorder(settings);
  for (int i = 0; i < 500; ++i) {
    if (i == 450) recorder.report_fault();
    if (i == 460) recorder.report_fault();  // the same one
    recorder.push_record(0, i, record_of(i));
  }
  recorder.finish();
  EXPECT_EQ(recorder.status().faults_saved, 1);
  const std::vector<LogEvent> events = read_log(folder / "faults" / "fault_1.lcmlog");
  ASSERT_EQ(events.size(), 102u);
  EXPECT_EQ(session_text(events.front(), ""), "text");
  for (int i = 0; i < 100; ++i) EXPECT_EQ(number_in(events[static_cast<std::size_t>(i) + 1].data), 380 + i);
  EXPECT_EQ(text_in(events.back()), "lost: 0\n");
}

TEST(Recorder, SavesAFaultWhileTheLoopGoesOn) {
  const TemporaryFolder folder;
  RecorderSettings settings{.channels = {"IN"}, .history_events = 1000, .events_after_fault = 10};
  settings.fault_folder = folder.path();
  Recorder recorder(settings);
  std::int64_t pushed = 0;
  for (; pushed < 2000; ++pushed) recorder.push_record(0, pushed, record_of(pushed));
  recorder.report_fault();
  while (recorder.status().faults_saved == 0) {
    recorder.push_record(0, pushed, record_of(pushed));
    ++pushed;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::int64_t expected = 1010, last = -1;
  for (const LogEvent& event : read_log(folder / "fault_1.lcmlog")) {
    if (event.channel != "IN") continue;
    last = number_in(event.data);
    EXPECT_EQ(last, expected++);
  }
  EXPECT_EQ(last, 2009);
}

TEST(Recorder, LeavesTheFaultsOfEarlierSessions) {
  const TemporaryFolder folder;
  for (int session = 1; session <= 3; ++session) {
    RecorderSettings settings{.channels = {"IN"}, .history_events = 10};
    settings.fault_folder = folder.path();
    Recorder recorder(settings);
    recorder.push_record(0, 0, record_of(session));
    recorder.report_fault();
  }
  for (int session = 1; session <= 3; ++session) {
    const auto events = read_log(folder / ("fault_" + std::to_string(session) + ".lcmlog"));
    EXPECT_EQ(number_in(events.at(1).data), session);
  }
}

TEST(Recorder, RefusesWhatCannotWork) {
  EXPECT_THROW(Recorder({.session_file = "/nowhere/at/all"}), InputError);
  EXPECT_THROW(Recorder({.channels = {""}}), InputError);
  EXPECT_THROW(Recorder({.channels = {std::string(64, 'x')}}), InputError);
}

TEST(Recorder, KnowsItsOwnSessions) {
  const auto event = [](const char* channel, const std::string& text) {
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    return LogEvent{0, channel, {bytes, bytes + text.size()}};
  };
  EXPECT_EQ(session_text(event("ERARD_SESSION", "erard session 1\na\nb"), ""), "a\nb");
  EXPECT_THROW(session_text(event("ERARD_SESSION", "erard session 2\na"), ""), InputError);
  EXPECT_THROW(session_text(event("ERARD_SESSION", "erard session 1"), ""), InputError);
  EXPECT_THROW(session_text(event("KEY", "erard session 1\na"), ""), InputError);
}

}  // namespace
}  // namespace erard
