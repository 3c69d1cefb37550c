// LCM log files: what lcm-logger writes and lcm-logplayer reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace erard {

/// One message of a log.
struct LcmLogEvent {
  std::int64_t time_us = 0;  // wall clock when the logger received it: not always rising [us]
  std::string channel;
  std::vector<std::uint8_t> payload;
};

/// The file begins like an LCM log. Throws InputError when it cannot be read.
bool is_lcm_log(const std::filesystem::path& file);

/// Reads a log event by event.
/// Event: magic EDA1DA01, number (8 bytes), time (8), length of channel (4), of payload (4), channel, payload; integers
/// with the most significant byte first.                                        LCM Log File Format
/// LCM's library is not asked: it believes the lengths, and a damaged file ends the program.
class LcmLogReader {
 public:
  /// Throws InputError when the file cannot be opened.
  explicit LcmLogReader(const std::filesystem::path& file);

  /// Reads the next event into `event`, whose memory is used again.
  /// @return false at the end of the file
  /// Throws InputError with the place when the file is damaged there.
  bool next(LcmLogEvent& event);

  /// Starts over.
  void rewind();

  /// The file ends within an event, as when a logger was killed or its disk was full; that event is left out.
  bool is_cut_short() const noexcept { return is_cut_short_; }

 private:
  bool read(void* bytes, std::uint64_t count);

  std::filesystem::path file_;
  std::ifstream in_;
  std::uint64_t size_ = 0, position_ = 0;  // [byte]
  bool is_cut_short_ = false;
};

}  // namespace erard
