// Event logs are LCM's, and keep what is whole.
#include "erard/device/event_log.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "support/program.hpp"
#include "support/records.hpp"
#ifdef ERARD_HAS_LCM
#include <lcm/eventlog.h>
#endif

namespace erard {
namespace {

namespace fs = std::filesystem;
using test::complaint_of;
using test::FileSizeLimit;
using test::number_in;
using test::read_log;
using test::read_text;
using test::Record;
using test::record_of;
using test::TemporaryFolder;
using test::write_text;

/// A log of `count` events of 28 + 3 + 69 bytes.
constexpr std::size_t kEventBytes = 28 + 3 + sizeof(Record);
void write_log(const fs::path& file, int count) {
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

}  // namespace
}  // namespace erard
