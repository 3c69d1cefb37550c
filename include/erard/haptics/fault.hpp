// What can go wrong, or be held back, between a position and a force: one bit each, and how often.
#pragma once

#include <array>
#include <cstdint>

namespace erard {

/// One bit each; a period or a key has any number of them.
enum class Fault : std::uint32_t {
  none = 0,
  // of a message
  duplicate = 1u << 0,          // its sequence is the last one's
  reordered = 1u << 1,          // its sequence lies before the last one's
  gap = 1u << 2,                // messages before it were lost; it counts
  foreign_publisher = 1u << 3,  // somebody else holds the channel
  stale_time = 1u << 4,         // its device time stands still or is behind by more than the timeout
  wrong_size = 1u << 5,         // not one position for each key
  // of the position of a key
  not_finite_input = 1u << 6,
  out_of_range = 1u << 7,
  implausible_speed = 1u << 8,
  no_input = 1u << 9,    // none for longer than the timeout: the force fades
  realigned = 1u << 10,  // the simulated finger is on its way to where the key really is
  // of the simulation
  step_not_finite = 1u << 11,     // the action keeps its last good state
  step_not_converged = 1u << 12,  // an iteration limit was reached: a statistic, not an error
  // of the force
  passivity_acted = 1u << 13,
  force_limited = 1u << 14,
  slew_limited = 1u << 15,
  current_limited = 1u << 16,
  thermal_limited = 1u << 17,
  cannot_push = 1u << 18,  // a brake was asked for a force along the motion
  // of the host
  wrong_type = 1u << 19,         // another type or kind of message on the channel
  overflow = 1u << 20,           // more messages than a period takes
  publish_failed = 1u << 21,     // a force could not be sent
  period_missed = 1u << 22,      // the work of a period ended after the next one was due
  recording_stopped = 1u << 23,  // the disk refused
  coarser_steps = 1u << 24,      // more keys are awake than the step budget is for: a statistic, not an error
};
inline constexpr int kFaultCount = 25;

constexpr Fault operator|(Fault a, Fault b) noexcept {
  return static_cast<Fault>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr Fault operator&(Fault a, Fault b) noexcept {
  return static_cast<Fault>(static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(b));
}
constexpr Fault operator~(Fault a) noexcept { return static_cast<Fault>(~static_cast<std::uint32_t>(a)); }
constexpr Fault& operator|=(Fault& a, Fault b) noexcept { return a = a | b; }
constexpr bool has(Fault all, Fault one) noexcept {
  return (static_cast<std::uint32_t>(all) & static_cast<std::uint32_t>(one)) != 0;
}

/// Name of bit i, 0 <= i < kFaultCount.
inline constexpr const char* fault_name(int i) noexcept {
  constexpr std::array<const char*, kFaultCount> names{"duplicate",          "reordered",       "gap",
                                                       "foreign_publisher",  "stale_time",      "wrong_size",
                                                       "not_finite_input",   "out_of_range",    "implausible_speed",
                                                       "no_input",           "realigned",       "step_not_finite",
                                                       "step_not_converged", "passivity_acted", "force_limited",
                                                       "slew_limited",       "current_limited", "thermal_limited",
                                                       "cannot_push",        "wrong_type",      "overflow",
                                                       "publish_failed",     "period_missed",   "recording_stopped",
                                                       "coarser_steps"};
  return names[static_cast<std::size_t>(i)];
}

/// How often each was seen.
struct FaultCounters {
  std::array<std::int64_t, kFaultCount> count{};  // messages, or keys times periods
  std::array<std::int64_t, kFaultCount> began{};  // periods in which some key has it and none had in the period before

  void add(Fault faults) noexcept {
    std::uint32_t bits = static_cast<std::uint32_t>(faults);
    for (std::size_t i = 0; bits != 0; ++i, bits >>= 1) count[i] += bits & 1u;
  }
  /// @param faults  of the message and of all keys
  void end_period(Fault faults) noexcept {
    std::uint32_t bits = static_cast<std::uint32_t>(faults) & ~static_cast<std::uint32_t>(before_);
    for (std::size_t i = 0; bits != 0; ++i, bits >>= 1) began[i] += bits & 1u;
    before_ = faults;
  }
  /// Of one bit.
  std::int64_t operator[](Fault one) const noexcept {
    std::uint32_t bits = static_cast<std::uint32_t>(one);
    std::size_t i = 0;
    while (bits > 1) bits >>= 1, ++i;
    return count[i];
  }

 private:
  Fault before_ = Fault::none;
};

}  // namespace erard
