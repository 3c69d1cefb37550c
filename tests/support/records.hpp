// Records whose every byte can be checked, the logs they lie in, and disks that fill up.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "erard/device/error.hpp"
#include "erard/device/event_log.hpp"

namespace erard::test {

/// Odd in size; every byte tells its number.
struct Record {
  std::int64_t number = 0;
  std::uint8_t copies[61] = {};
};
inline Record record_of(std::int64_t number) {
  Record record{number, {}};
  for (std::uint8_t& copy : record.copies) copy = static_cast<std::uint8_t>(number);
  return record;
}

inline std::int64_t number_in(const std::vector<std::byte>& data) {
  Record record;
  EXPECT_EQ(data.size(), sizeof record);
  std::memcpy(&record, data.data(), sizeof record);
  for (const std::uint8_t copy : record.copies) EXPECT_EQ(copy, static_cast<std::uint8_t>(record.number));
  return record.number;
}

inline std::string text_in(const LogEvent& event) {
  return {reinterpret_cast<const char*>(event.data.data()), event.data.size()};
}

inline std::vector<LogEvent> read_log(const std::filesystem::path& file) {
  EventLogReader reader(file);
  std::vector<LogEvent> events;
  while (auto event = reader.next()) events.push_back(std::move(*event));
  return events;
}

inline std::string complaint_of(const std::filesystem::path& file) {
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

}  // namespace erard::test
