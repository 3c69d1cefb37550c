// Event logs as LCM writes them: lcm-logplayer and its kin read what this writes, and the other way round.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace erard {

/// The format, all numbers big-endian: sync word EDA1DA01, event number (8 bytes), time in us (8), length of the
/// channel (4), length of the data (4), channel, data. lcm-logger writes the time of day; ours is the monotonic clock,
/// and players look at differences alone. Nanoseconds belong into the data.
///
/// Written by hand and not by liblcm: its writer leaves half an event when the disk is full, its reader searches
/// silently for the next sync word when the file is damaged and prints to stderr. The tests hold both against it.
struct LogEvent {
  std::int64_t time_us = 0;
  std::string channel;  // 1 to 63 characters
  std::vector<std::byte> data;
};

/// Whether a file begins like a log. Throws InputError when it cannot be read.
bool is_event_log(const std::filesystem::path& path);

/// Appends events to a new file. Once the disk refuses, it stops for good: the file keeps every event that is whole.
class EventLogWriter {
 public:
  /// Throws InputError when the file cannot be made.
  explicit EventLogWriter(std::filesystem::path path);
  ~EventLogWriter();
  EventLogWriter(const EventLogWriter&) = delete;
  EventLogWriter& operator=(const EventLogWriter&) = delete;

  /// Into memory, and from there into the file in blocks of 256 KiB.
  /// @param channel  1 to 63 characters @param data  at most 64 MiB
  void append(std::int64_t time_ns, std::string_view channel, std::span<const std::byte> data);
  void append(std::int64_t time_ns, std::string_view channel, std::string_view text);

  void flush();  // what is in memory
  void close();  // after it nothing is appended

  bool is_writing() const noexcept { return file_ >= 0 && trouble_.empty(); }
  const std::string& trouble() const noexcept { return trouble_; }  // one sentence; empty: none
  std::int64_t events() const noexcept { return events_; }          // whole, in the file
  std::int64_t bytes() const noexcept { return bytes_; }            // of them

 private:
  void give_up(std::size_t accepted, int error);

  std::filesystem::path path_;
  int file_ = -1;
  std::string block_;
  std::vector<std::size_t> ends_;  // of the events in block_
  std::int64_t events_ = 0, bytes_ = 0;
  std::string trouble_;
};

/// Reads events one by one. A file that ends within an event, as after a crash, is read up to there.
class EventLogReader {
 public:
  /// Throws InputError when the file cannot be read or does not begin like a log.
  explicit EventLogReader(std::filesystem::path path);

  /// @return the next event; nothing at the end. Throws InputError where the file is damaged: event, byte, what is
  /// wrong.
  std::optional<LogEvent> next();

  bool is_truncated() const noexcept { return is_truncated_; }  // known at the end
  std::int64_t events() const noexcept { return events_; }      // so far

 private:
  [[noreturn]] void refuse(const std::string& what) const;

  std::filesystem::path path_;
  std::ifstream stream_;
  std::int64_t size_ = 0, place_ = 0;  // [B] of the file; of the next event
  std::int64_t events_ = 0;
  bool is_truncated_ = false;
};

}  // namespace erard
