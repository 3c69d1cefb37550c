// What is recorded is what was pushed, whatever the disk and the other threads do. Also run under the thread sanitizer.
#include "erard/device/recorder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <thread>

#include "erard/device/error.hpp"
#include "support/program.hpp"
#ifdef ERARD_HAS_LCM
#include <lcm/eventlog.h>
#endif

namespace erard {
namespace {

using test::read_text;
using test::TemporaryFolder;
using test::write_text;
namespace fs = std::filesystem;
using fs::path;

/// Odd in size; every byte tells its number.
struct Record {
  std::int64_t number = 0;
  std::uint8_t copies[61] = {};
};
Record record_of(std::int64_t number) {
  Record record{number, {}};
  for (std::uint8_t& copy : record.copies) copy = static_cast<std::uint8_t>(number);
  return record;
}

std::int64_t number_in(const std::vector<std::byte>& data) {
  Record record;
  EXPECT_EQ(data.size(), sizeof record);
  std::memcpy(&record, data.data(), sizeof record);
  for (const std::uint8_t copy : record.copies) EXPECT_EQ(copy, static_cast<std::uint8_t>(record.number));
  return record.number;
}

std::string text_in(const LogEvent& event) {
  return {reinterpret_cast<const char*>(event.data.data()), event.data.size()};
}

std::vector<LogEvent> read_log(const path& file) {
  EventLogReader reader(file);
  std::vector<LogEvent> events;
  while (auto event = reader.next()) events.push_back(std::move(*event));
  return events;
}

std::string complaint_of(const path& file) {
  try {
    read_log(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// A file may grow to that many bytes, as on a disk that fills up. (The limit needs no rights, a full disk does.)
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit less{bytes, limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &less);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }

 private:
  rlimit limit_{};
  void (*before_)(int);
};

/// A log of `count` events of 28 + 3 + 69 bytes.
constexpr std::size_t kEventBytes = 28 + 3 + sizeof(Record);
void write_log(const path& file, int count) {
  EventLogWriter log(file);
  for (int i = 0; i < count; ++i) {
    const Record record = record_of(i);
    log.append(1'000'000LL * i, "KEY", std::as_bytes(std::span(&record, 1)));
  }
}

TEST(EventLog, GivesBackWhatWasAppended) {
  const TemporaryFolder folder;
  write_log(folder / "a", 5000);  // more than a block
  const std::vector<LogEvent> events = read_log(folder / "a");
  ASSERT_EQ(events.size(), 5000u);
  for (int i = 0; i < 5000; ++i) {
    const LogEvent& event = events[static_cast<std::size_t>(i)];
    ASSERT_EQ(number_in(event.data), i);
    ASSERT_EQ(event.channel, "KEY");
    ASSERT_EQ(event.time_us, 1000 * i);
  }
}

TEST(EventLog, IsTheFormatOfLcm) {
  const TemporaryFolder folder;
  EventLogWriter log(folder / "a");
  log.append(0x0102030405 * 1000, "AB", std::string_view("x"));
  log.append(-1'000'000, "C", std::string_view());
  log.close();
  using namespace std::string_literals;
  EXPECT_EQ(read_text(folder / "a"), "\xED\xA1\xDA\x01\0\0\0\0\0\0\0\0\0\0\0\1\2\3\4\5\0\0\0\2\0\0\0\1"s + "ABx"s +
                                         "\xED\xA1\xDA\x01\0\0\0\0\0\0\0\1\xff\xff\xff\xff\xff\xff\xfc\x18"s +
                                         "\0\0\0\1\0\0\0\0C"s);
}

TEST(EventLog, IsReadUpToTheLastWholeEventWhereverItEnds) {
  const TemporaryFolder folder;
  write_log(folder / "a", 3);
  const std::string whole = read_text(folder / "a");
  ASSERT_EQ(whole.size(), 3 * kEventBytes);
  for (std::size_t size = 4; size <= whole.size(); ++size) {
    write_text(folder / "cut", whole.substr(0, size));
    EventLogReader reader(folder / "cut");
    std::size_t events = 0;
    while (reader.next()) ++events;
    ASSERT_EQ(events, size / kEventBytes) << size;
    ASSERT_EQ(reader.is_truncated(), size % kEventBytes != 0) << size;
  }
}

TEST(EventLog, RefusesForeignFilesInOneSentence) {
  const TemporaryFolder folder;
  write_text(folder / "csv", "t_s,position_m\n0,0\n");
  EXPECT_NE(complaint_of(folder / "csv").find("csv: is no LCM log"), std::string::npos);
  write_text(folder / "short", "\xED\xA1");
  EXPECT_NE(complaint_of(folder / "short").find("is no LCM log"), std::string::npos);
  write_text(folder / "empty", "");
  EXPECT_NE(complaint_of(folder / "empty").find("is empty"), std::string::npos);
  EXPECT_NE(complaint_of(folder / "absent").find("absent: cannot be read (No such file"), std::string::npos);
  EXPECT_NE(complaint_of(folder.path()).find("it is a folder"), std::string::npos);
}

TEST(EventLog, TellsWhereAFileIsDamaged) {
  const TemporaryFolder folder;
  write_log(folder / "a", 3);
  const std::string whole = read_text(folder / "a");
  const struct {
    std::size_t offset;
    const char* bytes;
    const char* complaint;
  } damages[] = {{0, "\xED\xA1\xDA\x02", "does not begin with the bytes ED A1 DA 01"},
                 {20, "\x7f", "length of the channel = 2130706435, must be 1 to 63"},
                 {20, "\xff", "length of the channel = -16777213, must be 1 to 63"},
                 {24, "\x7f", "length of the data = 2130706"},
                 {24, "\x80", "length of the data = -2147483"}};
  for (const auto& damage : damages) {
    std::string damaged = whole;
    damaged.replace(kEventBytes + damage.offset, std::strlen(damage.bytes), damage.bytes);
    write_text(folder / "b", damaged);
    const std::string complaint = complaint_of(folder / "b");
    EXPECT_NE(complaint.find("b: event 1 at byte " + std::to_string(kEventBytes)), std::string::npos) << complaint;
    EXPECT_NE(complaint.find(damage.complaint), std::string::npos) << complaint;
    EXPECT_EQ(complaint.find('\n'), std::string::npos);
  }
}

TEST(EventLog, KeepsWholeEventsWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  for (const rlim_t limit : {rlim_t{0}, rlim_t{50}, rlim_t{400'000}, rlim_t{10 * kEventBytes}}) {
    const FileSizeLimit full(limit);
    EventLogWriter log(folder / "a");
    const Record record = record_of(1);
    for (int i = 0; i < 10'000; ++i) log.append(0, "KEY", std::as_bytes(std::span(&record, 1)));
    log.flush();
    EXPECT_FALSE(log.is_writing());
    EXPECT_NE(log.trouble().find("a: recording stopped after"), std::string::npos) << log.trouble();
    log.append(0, "KEY", std::string_view("no more"));
    log.close();
    EXPECT_EQ(log.events(), static_cast<std::int64_t>(limit / kEventBytes));
    EXPECT_EQ(fs::file_size(folder / "a"), limit / kEventBytes * kEventBytes);
    EXPECT_EQ(log.bytes(), static_cast<std::int64_t>(fs::file_size(folder / "a")));
  }
}

TEST(EventLog, RefusesAPlaceThatCannotBeWritten) { EXPECT_THROW(EventLogWriter("/nowhere/at/all"), InputError); }

#ifdef ERARD_HAS_LCM
TEST(EventLog, IsReadByLcm) {
  const TemporaryFolder folder;
  write_log(folder / "a", 100);
  lcm_eventlog_t* log = lcm_eventlog_create((folder / "a").c_str(), "r");
  ASSERT_NE(log, nullptr);
  for (int i = 0; i < 100; ++i) {
    lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log);
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->eventnum, i);
    EXPECT_EQ(event->timestamp, 1000 * i);
    EXPECT_EQ(std::string(event->channel, static_cast<std::size_t>(event->channellen)), "KEY");
    const auto* data = static_cast<const std::byte*>(event->data);
    EXPECT_EQ(number_in({data, data + event->datalen}), i);
    lcm_eventlog_free_event(event);
  }
  EXPECT_EQ(lcm_eventlog_read_next_event(log), nullptr);
  lcm_eventlog_destroy(log);
}

TEST(EventLog, ReadsWhatLcmWrote) {
  const TemporaryFolder folder;
  lcm_eventlog_t* log = lcm_eventlog_create((folder / "a").c_str(), "w");
  char channel[] = "KEY";
  for (int i = 0; i < 100; ++i) {
    Record record = record_of(i);
    lcm_eventlog_event_t event{i, 1'700'000'000'000'000 + i, 3, sizeof record, channel, &record};
    ASSERT_EQ(lcm_eventlog_write_event(log, &event), 0);
  }
  lcm_eventlog_destroy(log);
  const std::vector<LogEvent> events = read_log(folder / "a");
  ASSERT_EQ(events.size(), 100u);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(number_in(events[static_cast<std::size_t>(i)].data), i);
    EXPECT_EQ(events[static_cast<std::size_t>(i)].time_us, 1'700'000'000'000'000 + i);
  }
}
#endif

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

TEST(EventRing, ReadersSeeWholeEventsWhileItIsOverwritten) {
  // 8 slots only: the writer overtakes all the time
  EventRing ring(8, sizeof(Record));
  constexpr std::int64_t kEvents = 200'000;
  std::atomic<bool> is_reading{false};
  std::thread reader([&] {
    RingEvent event;
    is_reading = true;
    for (std::uint64_t number = 0; number < kEvents;) {
      const EventRing::Found found = ring.read(number, event);
      if (found == EventRing::Found::whole) {
        ASSERT_EQ(number_in(event.data), static_cast<std::int64_t>(number));
        ASSERT_EQ(event.time_ns, static_cast<std::int64_t>(number));
        ++number;
      } else if (found == EventRing::Found::overwritten) {
        number = std::max(number + 1, ring.oldest());
      }
    }
  });
  while (!is_reading) std::this_thread::yield();
  for (std::int64_t i = 0; i < kEvents; ++i) {
    const Record record = record_of(i);
    ring.push(0, i, std::as_bytes(std::span(&record, 1)));
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
