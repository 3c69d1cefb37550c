// The real-time loop: the same work on every point of a time grid, and an account of the periods that were missed.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <type_traits>

#include "erard/device/loop_status.hpp"
#include "erard/device/monotonic_clock.hpp"
#include "erard/device/seqlock.hpp"
#include "erard/device/shared_histogram.hpp"

namespace erard {

struct LoopSettings {
  std::int64_t period_ns = 500'000;              // > 0
  std::int64_t phase_ns = 0;                     // grid points are at phase + k period of the clock
  std::int64_t late_bound_ns = 100'000;          // a period may begin that long after its grid point
  std::int64_t interruption_bound_ns = 100'000;  // the clock may run ahead of the CPU time that long
};

/// One turn of the loop, as the work sees it.
struct Period {
  std::int64_t number = 0;   // of its grid point, from 0; those left out are counted too
  std::int64_t due_ns = 0;   // the grid point
  std::int64_t woke_ns = 0;  // when it began
  std::int64_t skipped = 0;  // grid points left out just before this one
};

/// Wakes at absolute times, so that lateness never adds up, and keeps its phase through whatever happens: a period that
/// was missed moves no other. A period that cannot begin within `late_bound` of its grid point, since the work before it
/// still went on, is left out.
///
/// Each period costs two looks at the clock and one at the CPU time of the thread. The latter enters the kernel (0.4 us),
/// so it is read once, after the work, when the force is already out, and serves the next period as its beginning: a
/// thread that sleeps uses no CPU. What it takes to fall asleep and to wake, a few us, counts as work that way, against
/// an interruption_bound of 100 us.
///
/// No heap, no lock, no exception; run() belongs to one thread, status(), the histograms and stop() to anybody.
/// @tparam Clock  as MonotonicClock
template <class Clock = MonotonicClock>
class PeriodicLoop {
 public:
  explicit PeriodicLoop(const LoopSettings& settings, Clock clock = {}) noexcept : settings_(settings), clock_(clock) {}

  /// Works on the points of the grid, the first one ahead at first, until stop() or until the work returns false.
  /// @param work  bool(const Period&) noexcept
  template <class Work>
  LoopSummary run(Work&& work) noexcept {
    return run(work, [this](std::int64_t due) noexcept {
      clock_.sleep_until(due);
      return due;
    });
  }

  /// The same with another way of waiting, for instance for a message.
  /// @param wait  int64(int64 due) noexcept: sleeps until whatever begins the period, though not (much) longer than
  ///              `due`, the next grid point; returns when the period had to begin [ns]. The grid goes on from there.
  template <class Work, class Wait>
  LoopSummary run(Work&& work, Wait&& wait) noexcept {
    static_assert(std::is_nothrow_invocable_r_v<bool, Work&, const Period&>);
    static_assert(std::is_nothrow_invocable_r_v<std::int64_t, Wait&, std::int64_t>);
    Period period;
    period.due_ns = first_grid_point(clock_.now());
    const ThreadUsage before = clock_.thread_usage();
    std::int64_t cpu = clock_.thread_cpu_time();
    while (!is_stopped_.load(std::memory_order_relaxed)) {
      period.due_ns = wait(period.due_ns);
      period.woke_ns = clock_.now();
      const bool goes_on = work(static_cast<const Period&>(period));
      const std::int64_t end = clock_.now(), cpu_end = clock_.thread_cpu_time();
      const std::int64_t next = period.due_ns + settings_.period_ns + take_shift();
      account(period, end, cpu_end - cpu, next);
      cpu = cpu_end;
      if (!goes_on) break;
      advance(period, next, end);
    }
    return {status_, clock_.thread_usage() - before};
  }

  /// Moves the grid from the next period on [ns]; for the work, see PhaseLock.
  void shift(std::int64_t by_ns) noexcept { shift_ns_ += by_ns; }

  /// Periods missed before this one; for the work.
  std::int64_t missed() const noexcept { return status_.missed; }

  /// Ends run() after the period under way. Also for signal handlers.
  void stop() noexcept { is_stopped_.store(true, std::memory_order_relaxed); }

  LoopStatus status() const noexcept { return published_.load(); }  // from slower threads; see Seqlock::load()
  DurationHistogram wake_lateness() const noexcept { return lateness_.snapshot(); }
  DurationHistogram work_time() const noexcept { return work_.snapshot(); }  // on the clock
  const LoopSettings& settings() const noexcept { return settings_; }

 private:
  std::int64_t first_grid_point(std::int64_t now) const noexcept {
    const std::int64_t period = settings_.period_ns, past = (now - settings_.phase_ns) % period;
    return now - past + (past < 0 ? 0 : period);
  }

  std::int64_t take_shift() noexcept {
    const std::int64_t by = shift_ns_;
    shift_ns_ = 0;
    status_.shifted_ns += by;
    return by;
  }

  void account(const Period& period, std::int64_t end, std::int64_t cpu, std::int64_t next) noexcept {
    const std::int64_t lateness = period.woke_ns - period.due_ns, work = end - period.woke_ns;
    ++status_.periods;
    status_.skipped += period.skipped;
    status_.last_lateness_ns = lateness;
    status_.last_work_ns = work;
    status_.worst_lateness_ns = std::max(status_.worst_lateness_ns, lateness);
    status_.worst_work_ns = std::max(status_.worst_work_ns, work);
    if (end > next) {
      ++status_.missed;
      status_.last_miss = {period.number, cause_of(lateness, work, cpu), lateness, work, cpu};
      ++status_.by_cause[static_cast<int>(status_.last_miss.cause)];
    }
    lateness_.add(1e-9 * static_cast<double>(lateness));
    work_.add(1e-9 * static_cast<double>(work));
    published_.store(status_);
  }

  MissCause cause_of(std::int64_t lateness, std::int64_t work, std::int64_t cpu) const noexcept {
    if (lateness > settings_.late_bound_ns) return MissCause::woke_late;
    if (work - cpu > settings_.interruption_bound_ns) return MissCause::interrupted;
    return MissCause::worked_long;
  }

  /// To the first grid point, from `next` on, whose period may still begin.
  void advance(Period& period, std::int64_t next, std::int64_t end) const noexcept {
    const std::int64_t behind = end - settings_.late_bound_ns - next, step = settings_.period_ns;
    period.skipped = behind > 0 ? (behind + step - 1) / step : 0;
    period.number += 1 + period.skipped;
    period.due_ns = next + period.skipped * step;
  }

  LoopSettings settings_;
  Clock clock_;
  LoopStatus status_;
  std::int64_t shift_ns_ = 0;  // asked for, not yet done
  Seqlock<LoopStatus> published_;
  SharedHistogram lateness_, work_;
  std::atomic<bool> is_stopped_{false};
};

}  // namespace erard
