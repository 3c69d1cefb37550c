#include "erard/device/verification.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <vector>

#include "erard/device/host_period.hpp"
#include "erard/device/session.hpp"

namespace erard {
namespace {

template <typename Message>
Message decode(const LogEvent& event, const std::filesystem::path& file, std::int64_t number) {
  Message message;
  const int size = static_cast<int>(event.data.size());
  if (message.decode(event.data.data(), 0, size) != size)
    throw InputError(
        fmt::format("{}: event {} on {} is no {}", file.string(), number, event.channel, Message::getTypeName()));
  return message;
}

/// The session over again, from its first event on.
class Repetition {
 public:
  Repetition(const std::filesystem::path& file, const SessionParts& parts)
      : file_(file),
        link_(parts.settings.link),
        renderer_(parts.action.model, parts.action.roles, parts.settings.rendering) {}

  /// @return whether a period was computed
  bool take(const LogEvent& event, std::int64_t number) {
    if (event.channel == link_.positions_channel) {
      positions_.push_back(decode<positions_t>(event, file_, number));
      return false;
    }
    if (event.channel != link_.forces_channel) return false;
    compare(decode<forces_t>(event, file_, number));
    positions_.clear();
    return true;
  }

  Verification result;

 private:
  void compare(const forces_t& recorded) {
    messages_.clear();
    for (const positions_t& p : positions_) messages_.push_back(position_message(p));
    const PeriodOutput& computed = renderer_.period({recorded.device_time_ns, messages_});
    ++result.periods;
    result.messages += static_cast<std::int64_t>(messages_.size());
    bool differs = false;
    for (int k = 0; k < renderer_.size(); ++k) {
      const double was = recorded.force_N[k], is = computed.key[static_cast<std::size_t>(k)].force;
      if (std::bit_cast<std::uint64_t>(was) == std::bit_cast<std::uint64_t>(is)) continue;
      result.largest = std::max(result.largest, std::abs(was - is));
      if (result.first_difference < 0) {
        result.first_difference = result.periods - 1;
        result.key = k;
        result.recorded = was;
        result.computed = is;
      }
      differs = true;
    }
    result.differing += differs ? 1 : 0;
  }

  const std::filesystem::path& file_;
  const LinkSettings& link_;
  Renderer renderer_;
  std::vector<positions_t> positions_;  // of the period
  std::vector<PositionMessage> messages_;
};

}  // namespace

Verification verify_session(const std::filesystem::path& file,
                            const std::function<bool(const Verification&)>& goes_on) {
  EventLogReader log(file);
  const std::optional<LogEvent> first = log.next();
  if (!first) throw InputError(fmt::format("{}: is empty, must be a recording of erard-device", file.string()));
  const SessionParts parts = load_session(session_from_text(session_text(*first, file), file.string()));
  Repetition repetition(file, parts);
  bool has_end = false;
  while (const std::optional<LogEvent> event = log.next()) {
    has_end = event->channel == Recorder::kEnd;
    if (has_end) break;
    if (event->channel == Recorder::kLost) {
      repetition.result.has_gap = true;
      return repetition.result;
    }
    if (repetition.take(*event, log.events()) && !goes_on(repetition.result)) return repetition.result;
  }
  repetition.result.is_cut_short = log.is_truncated() || !has_end;
  return repetition.result;
}

}  // namespace erard
