// What the real-time loop tells about itself.
#pragma once

#include <cstdint>

#include "erard/device/monotonic_clock.hpp"

namespace erard {

/// Why the work of a period ended after the next grid point: the first that holds.
enum class MissCause {
  woke_late,    // it began later than the stated bound
  interrupted,  // it took longer on the clock than on the CPU, by more than a bound: somebody else ran meanwhile
  worked_long,  // the work itself
};
inline constexpr int kMissCauses = 3;
constexpr const char* name_of(MissCause cause) {
  switch (cause) {
    case MissCause::woke_late: return "woke_late";
    case MissCause::interrupted: return "interrupted";
    case MissCause::worked_long: return "worked_long";
  }
  return "";
}

/// A period that was missed.
struct Miss {
  std::int64_t number = -1;  // of the period; -1: none so far
  MissCause cause{};
  std::int64_t lateness_ns = 0;  // of waking
  std::int64_t work_ns = 0;      // on the clock
  std::int64_t cpu_ns = 0;       // on the CPU, waking and falling asleep included (a few us)
};

/// Counters since the start, as of the end of the last period. Written once a period, read by anybody.
struct LoopStatus {
  std::int64_t periods = 0;  // worked
  std::int64_t skipped = 0;  // grid points that were left out
  std::int64_t missed = 0;   // worked past the next grid point: the sum of by_cause
  std::int64_t by_cause[kMissCauses] = {};
  std::int64_t last_lateness_ns = 0;
  std::int64_t last_work_ns = 0;
  std::int64_t worst_lateness_ns = 0;
  std::int64_t worst_work_ns = 0;
  std::int64_t shifted_ns = 0;  // the grid by now, against the one it began with
  Miss last_miss;

  std::int64_t missed_by(MissCause cause) const { return by_cause[static_cast<int>(cause)]; }
};

/// The whole of a run.
struct LoopSummary {
  LoopStatus status;
  ThreadUsage usage;  // between the first and the last period
};

}  // namespace erard
