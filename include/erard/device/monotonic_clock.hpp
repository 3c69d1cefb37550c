// The clock of the real-time loop: the kernel's monotonic one, in whole nanoseconds.
#pragma once

#include <sys/resource.h>
#include <time.h>

#include <cerrno>
#include <cstdint>

namespace erard {

/// What the kernel has counted for a thread.
struct ThreadUsage {
  long minor_faults = 0;          // pages that were there but not mapped
  long major_faults = 0;          // pages read from a disk
  long voluntary_switches = 0;    // the thread waited
  long involuntary_switches = 0;  // the CPU was taken from it

  friend ThreadUsage operator-(const ThreadUsage& a, const ThreadUsage& b) noexcept {
    return {a.minor_faults - b.minor_faults, a.major_faults - b.major_faults,
            a.voluntary_switches - b.voluntary_switches, a.involuntary_switches - b.involuntary_switches};
  }
};

/// Nobody sets CLOCK_MONOTONIC: unlike the time of day it never jumps. It counts from the start of the machine, so
/// programs on one machine share it.
struct MonotonicClock {
  std::int64_t now() const noexcept { return read(CLOCK_MONOTONIC); }  // [ns], 20 to 50 ns a look

  /// CPU time of this thread [ns]. Enters the kernel: 0.4 us where now() takes 0.02.
  std::int64_t thread_cpu_time() const noexcept { return read(CLOCK_THREAD_CPUTIME_ID); }

  /// Sleeps to an absolute time [ns], through signals; a time gone by returns at once.
  void sleep_until(std::int64_t time) const noexcept {
    const timespec until{time / kSecond, time % kSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }

  ThreadUsage thread_usage() const noexcept {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return {usage.ru_minflt, usage.ru_majflt, usage.ru_nvcsw, usage.ru_nivcsw};
  }

 private:
  static constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]
  static std::int64_t read(clockid_t clock) noexcept {
    timespec time{};
    clock_gettime(clock, &time);
    return time.tv_sec * kSecond + time.tv_nsec;
  }
};

}  // namespace erard
