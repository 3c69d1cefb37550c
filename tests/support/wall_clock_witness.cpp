// Put under a program by LD_PRELOAD, sets the time of day an hour forth and back every 100 ms, and counts who looks at
// it. Writes two lines when the program ends, the time of day and the monotonic clock: looks elsewhere, in the
// real-time loop, behind it.
#include <sys/time.h>
#include <time.h>

#include "loop_thread.hpp"

namespace {

using erard::test::Calls;
using erard::test::place;

Calls wall{}, monotonic{};

constexpr time_t kStep = 3600;  // [s]

timespec look(clockid_t clock) noexcept {
  timespec time{};
  syscall(SYS_clock_gettime, clock, &time);
  return time;
}

timespec time_of_day() noexcept {
  wall[place].fetch_add(1, std::memory_order_relaxed);
  timespec time = look(CLOCK_REALTIME);
  const bool is_forth = look(CLOCK_MONOTONIC).tv_nsec / 100'000'000 % 2 == 0;
  time.tv_sec += is_forth ? kStep : -kStep;
  return time;
}

struct AtTheEnd {
  ~AtTheEnd() {
    erard::test::testify("wall", wall);
    erard::test::testify("monotonic", monotonic);
  }
} at_the_end;

}  // namespace

extern "C" {
int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_TAI) {
    *time = time_of_day();
    return 0;
  }
  if (clock == CLOCK_MONOTONIC) monotonic[place].fetch_add(1, std::memory_order_relaxed);
  return static_cast<int>(syscall(SYS_clock_gettime, clock, time));
}
int gettimeofday(timeval* time, void*) noexcept {
  const timespec now = time_of_day();
  *time = {now.tv_sec, now.tv_nsec / 1000};
  return 0;
}
time_t time(time_t* place_of_it) noexcept {
  const time_t now = time_of_day().tv_sec;
  if (place_of_it != nullptr) *place_of_it = now;
  return now;
}
int timespec_get(timespec* time, int base) noexcept {
  *time = time_of_day();
  return base;
}
}
