// Positions to publish, one message after the other, each with the instant it is due.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "erard/device/keystroke.hpp"
#include "erard/device/event_log.hpp"
#include "erard/positions_t.hpp"

namespace erard {

/// Positions with the times they were recorded at; who publishes them puts in publisher, sequence and time of his own.
class PositionSource {
 public:
  virtual ~PositionSource() = default;

  /// The next message.
  /// @param time_ns  since the first message, never falling [ns]
  /// @return false when there is no more
  virtual bool next(positions_t& positions, std::int64_t& time_ns) = 0;
  virtual void rewind() = 0;

  virtual std::int64_t duration_ns() const = 0;  // from the first message to the last [ns]
  virtual std::int64_t message_count() const = 0;
};

/// Which keys play a keystroke.
struct KeystrokeKeys {
  static constexpr int kAll = -1;

  int key_count = 1;  // in each message, 1 .. positions_t::kMaxKeys
  int key = kAll;     // the one that plays, the others stay at rest
  std::int8_t kind = positions_t::kPiston;
};

/// A keystroke, sampled at a constant rate along its spline.
class KeystrokeSource : public PositionSource {
 public:
  /// @param keystroke  positions; @param interval  between two samples, in time of the keystroke [s] > 0
  KeystrokeSource(Keystroke keystroke, double interval, KeystrokeKeys keys);

  bool next(positions_t& positions, std::int64_t& time_ns) override;
  void rewind() override { next_ = 0; }
  std::int64_t duration_ns() const override { return time_of(count_ - 1); }
  std::int64_t message_count() const override { return count_; }

 private:
  std::int64_t time_of(std::int64_t message) const;  // [ns]

  Keystroke keystroke_;
  double interval_;
  KeystrokeKeys keys_;
  std::int64_t count_;
  std::int64_t next_ = 0;
};

/// The positions_t of one channel of an LCM log, at the pace of the device's own clock.
///
/// The log's own time is the wall clock of the logger; it is taken only where the device's clock says nothing: another
/// publisher, time that falls or leaps by more than 10 s. There time that falls counts as none, and a silence of more
/// than 10 s as 10 s.
class LogSource : public PositionSource {
 public:
  /// Reads the whole file once. Throws InputError when it is damaged, or has no positions_t on that channel.
  LogSource(const std::filesystem::path& file, const std::string& channel);

  bool next(positions_t& positions, std::int64_t& time_ns) override;
  void rewind() override;
  std::int64_t duration_ns() const override { return duration_; }
  std::int64_t message_count() const override { return count_; }
  bool is_cut_short() const noexcept { return is_cut_short_; }

 private:
  /// When a message was made.
  struct LogTimes {
    std::int64_t publisher = 0;
    std::int64_t device_ns = 0;  // its device_time_ns [ns]
    std::int64_t logged_us = 0;  // wall clock of the logger [us]
  };

  std::filesystem::path file_;
  EventLogReader log_;
  std::string channel_;
  bool is_cut_short_ = false;
  LogTimes before_;  // of the last message
  bool is_first_ = true;
  std::int64_t time_ = 0;      // of the last message, since the first [ns]
  std::int64_t duration_ = 0;  // [ns]
  std::int64_t count_ = 0;
};

}  // namespace erard
