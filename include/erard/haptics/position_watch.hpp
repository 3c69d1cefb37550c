// Whom to believe: which messages of a channel count, and which of the positions in them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "erard/haptics/fault.hpp"

namespace erard {

/// Positions of all keys at one instant of the device, as they came.
struct PositionMessage {
  std::uint64_t publisher = 0;       // differs with each start of the device program
  std::int64_t sequence = 0;         // one more with each message
  std::int64_t device_time = 0;      // on the device's monotonic clock [ns]
  std::span<const double> position;  // of each key, down positive [m]
};

struct PositionWatchSettings {
  double timeout = 0.010;     // without a good position [s]
  double lowest = -0.003;     // position [m]
  double highest = 0.016;     // position [m]
  double max_speed = 3.0;     // of a key [m/s]
  int recovery_samples = 10;  // in a row that must fit together after a silence or a jump, > 0
};

/// Guards the channel. The first publisher that is heard keeps it until it has been silent for the timeout; then
/// whoever speaks next has it, with a sequence and a clock of its own: a device program that was restarted is heard again, and
/// so is one whose counters jumped.
///
/// A message is stale when its device time is not after the last one's, or when it has been under way for longer than
/// the timeout. Clocks of device and host have no common zero, so "under way" counts from the quickest message:
///   transit = host time - device time,  under way = transit - least transit so far
/// where the least one grows by kDrift a second, which follows clocks that drift apart.
class MessageWatch {
 public:
  MessageWatch(const PositionWatchSettings& settings, int keys) noexcept
      : timeout_(static_cast<std::int64_t>(settings.timeout * 1e9)), keys_(keys) {}

  /// @param host_time  of arrival or of the period that takes it, never decreasing [ns]
  /// @return whether it counts: no bit, or `gap` alone
  Fault look(const PositionMessage& message, std::int64_t host_time) noexcept {
    lost_ = 0;
    is_first_ = !has_channel_ || host_time - last_host_time_ > timeout_;
    if (!is_first_ && message.publisher != publisher_) return Fault::foreign_publisher;
    if (static_cast<std::int64_t>(message.position.size()) != keys_) return Fault::wrong_size;
    Fault faults = Fault::none;
    const double transit = static_cast<double>(host_time) - static_cast<double>(message.device_time);  // [ns]
    if (is_first_) {
      least_transit_ = transit;
    } else {
      if (message.sequence == sequence_) return Fault::duplicate;
      if (message.sequence < sequence_) return Fault::reordered;
      least_transit_ = std::min(transit, least_transit_ + kDrift * static_cast<double>(host_time - last_host_time_));
      const bool is_late = transit - least_transit_ > static_cast<double>(timeout_);
      if (message.device_time <= device_time_ || is_late) return Fault::stale_time;
      lost_ = static_cast<std::uint64_t>(message.sequence) - static_cast<std::uint64_t>(sequence_) - 1;
      if (lost_ != 0) faults |= Fault::gap;
    }
    has_channel_ = true;
    publisher_ = message.publisher;
    sequence_ = message.sequence;
    device_time_ = message.device_time;
    last_host_time_ = host_time;
    return faults;
  }

  /// Of the message accepted last: messages missing before it; whether it began the stream anew.
  std::uint64_t lost() const noexcept { return lost_; }
  bool is_first() const noexcept { return is_first_; }

 private:
  static constexpr double kDrift = 1e-3;  // [-] ten times what quartz clocks differ by at worst, 100 ppm

  std::int64_t timeout_;  // [ns]
  std::int64_t keys_;
  bool has_channel_ = false, is_first_ = false;
  std::uint64_t publisher_ = 0;
  std::int64_t sequence_ = 0, device_time_ = 0, last_host_time_ = 0;
  std::uint64_t lost_ = 0;
  double least_transit_ = 0;  // [ns]
};

/// What a sample is worth.
enum class SampleVerdict {
  good,      // goes on from the last good one
  resumed,   // good again: after a silence or a jump enough of them fitted together; may lie anywhere
  rejected,  // not to be used
};

/// Guards the position of one key. A sample counts when it is finite, within the limits and no further from the last
/// good one than max_speed allows,
///   |x - x_last| <= max_speed (t - t_last)          t: device time, the difference within T and the timeout
/// where an implausible sample counts as time, t_last = t, but not as place.
/// A key that jumped, or was not heard of for the timeout, counts again when `recovery_samples` in a row fit together
/// in this sense, wherever they are.
class KeyWatch {
 public:
  /// @param time      of the sample on the device [s], increasing
  /// @param period    T [s]
  /// @param is_new_stream  the device time has nothing to do with the last one's
  SampleVerdict look(const PositionWatchSettings& settings, double position, double time, double period,
                     bool is_new_stream, Fault& faults) noexcept {
    if (is_new_stream) is_tracked_ = false, run_ = 0;
    if (!std::isfinite(position)) {
      faults |= Fault::not_finite_input;
      return reject();
    }
    if (!(position >= settings.lowest && position <= settings.highest)) {
      faults |= Fault::out_of_range;
      return reject();
    }
    if (is_tracked_ && time - last_time_ > settings.timeout) is_tracked_ = false, run_ = 0;
    if (is_tracked_ && fits(settings, position - last_, time - last_time_, period)) {
      run_ = 0;
      accept(position, time);
      return SampleVerdict::good;
    }
    if (is_tracked_) {
      faults |= Fault::implausible_speed;
      last_time_ = time;  // or a jump would be within what max_speed allows before long
    }
    const bool goes_on = run_ > 0 && fits(settings, position - candidate_, time - candidate_time_, period);
    run_ = goes_on ? run_ + 1 : 1;
    candidate_ = position;
    candidate_time_ = time;
    if (run_ < settings.recovery_samples) return SampleVerdict::rejected;
    run_ = 0;
    accept(position, time);
    return SampleVerdict::resumed;
  }

 private:
  static bool fits(const PositionWatchSettings& settings, double way, double time, double period) noexcept {
    return std::abs(way) <= settings.max_speed * std::clamp(time, period, settings.timeout);
  }
  SampleVerdict reject() noexcept {
    run_ = 0;
    return SampleVerdict::rejected;
  }
  void accept(double position, double time) noexcept {
    is_tracked_ = true;
    last_ = position;
    last_time_ = time;
  }

  bool is_tracked_ = false;
  int run_ = 0;  // samples that fit together, the newest the candidate
  double last_ = 0, last_time_ = 0, candidate_ = 0, candidate_time_ = 0;  // [m], [s]
};

}  // namespace erard
