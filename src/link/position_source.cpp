#include "erard/device/position_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

#include "erard/device/error.hpp"

namespace erard {
namespace {

constexpr std::uint64_t kLongestSilence =
    10'000'000'000;  // that is replayed, and that a device's clock is believed [ns]

/// @return later - earlier, or the largest number when time falls
std::uint64_t pause(std::int64_t earlier, std::int64_t later) {
  return later < earlier ? UINT64_MAX : static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
}

/// The type alone counts: its fingerprint and size.
bool is_positions(const LogEvent& event) {
  static const auto size = static_cast<std::size_t>(positions_t{}.getEncodedSize());
  positions_t ignored;
  return event.data.size() == size && ignored.decode(event.data.data(), 0, static_cast<int>(size)) > 0;
}

std::set<std::string> channels_with_positions(const std::filesystem::path& file) {
  std::set<std::string> channels;
  EventLogReader log(file);
  while (const std::optional<LogEvent> event = log.next())
    if (is_positions(*event)) channels.insert(event->channel);
  return channels;
}

}  // namespace

KeystrokeSource::KeystrokeSource(Keystroke keystroke, double interval, KeystrokeKeys keys)
    : keystroke_(std::move(keystroke)), interval_(interval), keys_(keys) {
  const double duration = keystroke_.end() - keystroke_.start();
  count_ = static_cast<std::int64_t>(std::floor(duration / interval_ + 1e-9)) + 1;  // the end itself counts
}

std::int64_t KeystrokeSource::time_of(std::int64_t message) const {
  return std::llround(static_cast<double>(message) * interval_ * 1e9);
}

bool KeystrokeSource::next(positions_t& positions, std::int64_t& time_ns) {
  if (next_ == count_) return false;
  time_ns = time_of(next_);
  const double position = keystroke_.at(keystroke_.start() + static_cast<double>(next_) * interval_).value;
  ++next_;
  positions = {};
  positions.kind = keys_.kind;
  positions.key_count = keys_.key_count;
  for (int key = 0; key < keys_.key_count; ++key)
    positions.position_m[key] = keys_.key == KeystrokeKeys::kAll || key == keys_.key ? position : 0;
  return true;
}

LogSource::LogSource(const std::filesystem::path& file, const std::string& channel)
    : file_(file), log_(file), channel_(channel) {
  positions_t ignored;
  for (std::int64_t time = 0; next(ignored, time); ++count_) duration_ = time;
  is_cut_short_ = log_.is_truncated();
  rewind();
  if (count_ > 0) return;
  const std::set<std::string> others = channels_with_positions(file);
  throw InputError(fmt::format("{}: holds no erard.positions_t on channel {}{}{}", file.string(), channel_,
                               others.empty() ? "" : ", but on ", fmt::join(others, ", ")));
}

void LogSource::rewind() {
  log_ = EventLogReader(file_);
  time_ = 0;
  is_first_ = true;
}

bool LogSource::next(positions_t& positions, std::int64_t& time_ns) {
  std::optional<LogEvent> event;
  do {
    event = log_.next();
    if (!event) return false;
  } while (event->channel != channel_ || !is_positions(*event));
  const LogTimes before = before_;
  positions.decode(event->data.data(), 0, static_cast<int>(event->data.size()));
  before_ = {positions.publisher_id, positions.device_time_ns, event->time_us};
  if (!is_first_) {
    std::uint64_t silence = pause(before.device_ns, before_.device_ns);
    if (before.publisher != before_.publisher || silence > kLongestSilence) {
      const std::uint64_t logged_us = pause(before.logged_us, before_.logged_us);
      silence = logged_us == UINT64_MAX ? 0 : std::min(logged_us, kLongestSilence / 1000) * 1000;
    }
    time_ += static_cast<std::int64_t>(silence);
  }
  is_first_ = false;
  time_ns = time_;
  return true;
}

}  // namespace erard
