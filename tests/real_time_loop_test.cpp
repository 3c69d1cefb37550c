// The loop on a clock that is told what happens: every count is exact. No test here looks at the time of the machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <thread>
#include <vector>

#include "erard/device/periodic_loop.hpp"
#include "support/fake_clock.hpp"

namespace erard {
namespace {

using test::FakeClock;
using test::FakeTime;
using test::kT;
using test::kWork;
using test::us;

using Loop = PeriodicLoop<FakeClock>;

struct Played {
  std::vector<Period> periods;
  LoopSummary summary;
  LoopStatus status() const { return summary.status; }
};

/// Runs `count` periods of 50 us; the work of some lasts otherwise.
struct Odd {
  std::int64_t number, wall, cpu;
};
Played play(FakeTime& time, int count, const std::vector<Odd>& odd = {}, LoopSettings settings = {}) {
  Loop loop(settings, FakeClock{&time});
  Played played;
  played.summary = loop.run([&](const Period& period) noexcept {
    played.periods.push_back(period);
    Odd today{0, kWork, kWork};
    for (const Odd& each : odd)
      if (each.number == period.number) today = each;
    time.work(today.wall, today.cpu);
    return static_cast<int>(played.periods.size()) < count;
  });
  return played;
}

void expect_on_grid(const Played& played, std::int64_t first) {
  for (const Period& period : played.periods) EXPECT_EQ(period.due_ns, first + period.number * kT);
}

TEST(PeriodicLoop, WakesOnTheGridOfTheClockNotOfItsStart) {
  for (const std::int64_t start : {7 * us, kT - 1, kT, 12 * kT + 1}) {
    FakeTime time{start, 0, {}, {}};
    const Played played = play(time, 10);
    expect_on_grid(played, (start / kT + 1) * kT);
    EXPECT_EQ(played.periods.back().number, 9);
    EXPECT_EQ(played.status().periods, 10);
    EXPECT_EQ(played.status().missed, 0);
    EXPECT_EQ(played.status().skipped, 0);
  }
}

TEST(PeriodicLoop, PutsTheGridAtThePhaseAskedFor) {
  for (const std::int64_t start : {7 * us, 150 * us, 151 * us}) {
    FakeTime time{start, 0, {}, {}};
    expect_on_grid(play(time, 3, {}, {.phase_ns = 150 * us}), start < 150 * us ? 150 * us : 650 * us);
  }
}

TEST(PeriodicLoop, BeginsAtTheNextGridPointWhenThePhaseLiesAhead) {
  FakeTime time{7 * us, 0, {}, {}};
  expect_on_grid(play(time, 3, {}, {.phase_ns = 10 * kT + 3 * us}), kT + 3 * us);
}

TEST(PeriodicLoop, SleepsToAbsoluteTimesSoThatLatenessDoesNotAddUp) {
  FakeTime time;
  time.wake_delays = {40 * us, 30 * us, 60 * us, 20 * us};
  const Played played = play(time, 4);
  expect_on_grid(played, kT);
  EXPECT_EQ(played.periods[2].woke_ns - played.periods[2].due_ns, 60 * us);
  EXPECT_EQ(played.status().worst_lateness_ns, 60 * us);
  EXPECT_EQ(played.status().last_lateness_ns, 20 * us);
  EXPECT_EQ(played.status().missed, 0);
}

TEST(PeriodicLoop, WorkThatEndsOnTheNextGridPointIsInTime) {
  FakeTime time;
  EXPECT_EQ(play(time, 3, {{1, kT, kT}}).status().missed, 0);
  EXPECT_EQ(play(time, 3, {{1, kT + 1, kT + 1}}).status().missed, 1);
}

TEST(PeriodicLoop, TellsALateWake) {
  FakeTime time;
  time.wake_delays = {0, 480 * us};
  const Played played = play(time, 4);
  EXPECT_EQ(played.status().missed, 1);
  EXPECT_EQ(played.status().missed_by(MissCause::woke_late), 1);
  EXPECT_EQ(played.status().last_miss.number, 1);
  EXPECT_EQ(played.status().last_miss.lateness_ns, 480 * us);
  EXPECT_EQ(played.status().last_miss.work_ns, kWork);
  expect_on_grid(played, kT);
}

TEST(PeriodicLoop, TellsWorkThatIsLong) {
  FakeTime time;
  const Played played = play(time, 4, {{1, 510 * us, 410 * us}});  // off the CPU for the bound, not more
  EXPECT_EQ(played.status().missed, 1);
  EXPECT_EQ(played.status().missed_by(MissCause::worked_long), 1);
  EXPECT_EQ(played.status().last_miss.cpu_ns, 410 * us);
  EXPECT_EQ(played.status().worst_work_ns, 510 * us);
}

TEST(PeriodicLoop, TellsWorkThatWasInterrupted) {
  FakeTime time;
  const Played played = play(time, 4, {{1, 510 * us, 410 * us - 1}});
  EXPECT_EQ(played.status().missed, 1);
  EXPECT_EQ(played.status().missed_by(MissCause::interrupted), 1);
}

TEST(PeriodicLoop, BlamesALateWakeFromTheBoundOn) {
  FakeTime time;
  time.wake_delays = {100 * us, 0, 100 * us + 1};
  const Played played = play(time, 5, {{0, 450 * us, 450 * us}, {2, 450 * us, 450 * us}});
  EXPECT_EQ(played.status().missed, 2);
  EXPECT_EQ(played.status().missed_by(MissCause::worked_long), 1);
  EXPECT_EQ(played.status().missed_by(MissCause::woke_late), 1);
}

TEST(PeriodicLoop, BeginsAPeriodAtOnceThatIsNotTooLateAndSkipsNone) {
  FakeTime time;
  const Played played = play(time, 4, {{1, kT + 100 * us, kT + 100 * us}});
  EXPECT_EQ(played.status().skipped, 0);
  EXPECT_EQ(played.periods[2].number, 2);
  EXPECT_EQ(played.periods[2].woke_ns - played.periods[2].due_ns, 100 * us);
  expect_on_grid(played, kT);
}

TEST(PeriodicLoop, SkipsPeriodsThatAreTooLateAndKeepsThePhase) {
  FakeTime time;
  const Played played = play(time, 4, {{1, kT + 100 * us + 1, kT}, {3, 5 * kT, 5 * kT}});
  EXPECT_EQ(played.periods[2].number, 3);  // number 2 left out
  EXPECT_EQ(played.periods[2].skipped, 1);
  EXPECT_EQ(played.periods[3].number, 8);  // 4 to 7 left out; number 8 is due as the work ends
  EXPECT_EQ(played.periods[3].skipped, 4);
  EXPECT_EQ(played.status().skipped, 5);
  EXPECT_EQ(played.status().periods, 4);
  EXPECT_EQ(played.periods.back().number + 1, played.status().periods + played.status().skipped);
  expect_on_grid(played, kT);
}

TEST(PeriodicLoop, AccountsForEveryPeriodOfALongRoughRun) {
  FakeTime time;
  std::vector<Odd> odd;
  for (std::int64_t i = 0; i < 1000; ++i) {
    time.wake_delays.push_back((i * 7919) % (700 * us));
    odd.push_back({i, (i * 104729) % (900 * us), (i * 15485863) % (800 * us)});
  }
  const Played played = play(time, 600, odd);
  const LoopStatus status = played.status();
  expect_on_grid(played, kT);
  EXPECT_EQ(status.periods, 600);
  EXPECT_EQ(played.periods.back().number + 1, status.periods + status.skipped);
  EXPECT_EQ(status.missed, status.by_cause[0] + status.by_cause[1] + status.by_cause[2]);
  for (const std::int64_t count : status.by_cause) EXPECT_GT(count, 10);  // it was rough
}

TEST(PeriodicLoop, CountsFaultsAndSwitchesOfTheRunAlone) {
  FakeTime time;
  time.usage = {1000, 10, 500, 50};
  Loop loop({}, FakeClock{&time});
  const LoopSummary summary = loop.run([&](const Period&) noexcept {
    time.usage = {1033, 11, 502, 54};
    return false;
  });
  EXPECT_EQ(summary.usage.minor_faults, 33);
  EXPECT_EQ(summary.usage.major_faults, 1);
  EXPECT_EQ(summary.usage.voluntary_switches, 2);
  EXPECT_EQ(summary.usage.involuntary_switches, 4);
}

TEST(PeriodicLoop, HistogramsHoldEveryPeriod) {
  FakeTime time;
  for (int i = 0; i < 100; ++i) time.wake_delays.push_back(i < 90 ? 10 * us : 90 * us);
  Loop loop({}, FakeClock{&time});
  int left = 100;
  loop.run([&](const Period&) noexcept {
    time.work(kWork, kWork);
    return --left > 0;
  });
  const double bin = 0.01;  // the bins are 1 % wide
  EXPECT_EQ(loop.wake_lateness().total(), 100);
  EXPECT_NEAR(loop.wake_lateness().quantile(0.9), 10e-6, bin * 10e-6);
  EXPECT_NEAR(loop.wake_lateness().quantile(0.91), 90e-6, bin * 90e-6);
  EXPECT_NEAR(loop.work_time().quantile(0.5), 50e-6, bin * 50e-6);
  EXPECT_DOUBLE_EQ(loop.work_time().worst(), 50e-6);
}

TEST(PeriodicLoop, StopsAfterThePeriodUnderWay) {
  FakeTime time;
  Loop loop({}, FakeClock{&time});
  const LoopSummary summary = loop.run([&](const Period& period) noexcept {
    if (period.number == 4) loop.stop();
    return true;
  });
  EXPECT_EQ(summary.status.periods, 5);
  EXPECT_EQ(loop.status().periods, 5);
}

TEST(PeriodicLoop, IsReadByOthersWhileItRuns) {
  // under the thread sanitizer this is about more than the sums
  FakeTime time;
  Loop loop({}, FakeClock{&time});
  std::thread reader([&] {
    std::int64_t last = 0;
    for (int i = 0; i < 200; ++i) {
      const LoopStatus status = loop.status();
      EXPECT_GE(status.periods, last);
      EXPECT_EQ(status.missed, status.periods / 2);  // every other one, below
      EXPECT_GE(loop.work_time().total(), last);
      last = status.periods;
    }
    loop.stop();
  });
  const LoopSummary summary = loop.run([&](const Period&) noexcept {
    const bool is_long = loop.status().periods % 2 == 1;
    time.work(is_long ? kT + 1 : kWork, kWork);
    std::this_thread::yield();
    return true;
  });
  reader.join();
  EXPECT_EQ(loop.status().periods, summary.status.periods);
  EXPECT_EQ(loop.wake_lateness().total(), summary.status.periods);
}

TEST(PeriodicLoop, ShiftsItsGridFromTheNextPeriodOn) {
  FakeTime time;
  Loop loop({}, FakeClock{&time});
  std::vector<std::int64_t> due;
  const LoopSummary summary = loop.run([&](const Period& period) noexcept {
    due.push_back(period.due_ns);
    if (period.number == 1) loop.shift(3 * us);
    if (period.number == 2) loop.shift(-1 * us);
    return period.number < 3;
  });
  EXPECT_EQ(due, (std::vector<std::int64_t>{kT, 2 * kT, 3 * kT + 3 * us, 4 * kT + 2 * us}));
  EXPECT_EQ(summary.status.shifted_ns, 2 * us);
}

TEST(PeriodicLoop, FollowsMessagesInsteadOfTheClock) {
  // a message every 480 us; the fourth does not come, and the loop goes on at the grid point it was given
  FakeTime time;
  Loop loop({}, FakeClock{&time});
  std::deque<std::int64_t> arrivals = {480 * us, 960 * us, 1440 * us, 2400 * us};
  std::vector<std::int64_t> due;
  const auto wait = [&](std::int64_t deadline) noexcept {
    const bool comes = !arrivals.empty() && arrivals.front() < deadline;
    const std::int64_t begins = comes ? arrivals.front() : deadline;
    if (comes) arrivals.pop_front();
    time.now = std::max(time.now, begins + 13 * us);
    return begins;
  };
  const LoopSummary summary = loop.run(
      [&](const Period& period) noexcept {
        due.push_back(period.due_ns);
        time.work(kWork, kWork);
        return due.size() < 5;
      },
      wait);
  EXPECT_EQ(due, (std::vector<std::int64_t>{480 * us, 960 * us, 1440 * us, 1940 * us, 2400 * us}));
  EXPECT_EQ(summary.status.worst_lateness_ns, 13 * us);
  EXPECT_EQ(summary.status.missed, 0);
}

}  // namespace
}  // namespace erard
